#include "xml_document.hpp"

#include <algorithm>
#include <cctype>

#include "posewise/core/text.hpp"
#include "posewise/io/atomic_file.hpp"

namespace posewise::io {
namespace {

constexpr std::size_t most_bytes = std::size_t{4} << 20;
constexpr std::size_t most_tag_bytes = std::size_t{64} << 10;
constexpr int most_depth = 50;

}  // namespace

XmlDocument::XmlDocument(const std::string& path)
    : path_(path), content_(read_file(path, most_bytes)) {
    if (const auto nul = content_.find('\0'); nul != std::string::npos) {
        throw input_error_at(location(nul), "has a NUL byte; must be text in UTF-8");
    }
    scan();
    parse();
}

long XmlDocument::column(std::size_t position) const {
    const std::size_t before =
        position == 0 ? std::string::npos : content_.rfind('\n', position - 1);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    return static_cast<long>(position - first) + 1;
}

FileLocation XmlDocument::location(std::size_t position) const {
    const auto at = content_.begin() + static_cast<std::ptrdiff_t>(position);
    return {path_, std::count(content_.begin(), at, '\n') + 1, column(position)};
}

FileLocation XmlDocument::location(const tinyxml2::XMLElement& element) const {
    return {path_, element.GetLineNum(), column(tag(element).begin)};
}

std::size_t XmlDocument::find_end(std::size_t position, std::string_view ending,
                                  const char* what) const {
    const std::size_t end = content_.find(ending, position);
    if (end != std::string::npos) return end + ending.size();
    throw input_error_at(location(position), std::string("begins ") + what + " that never ends");
}

/// The position behind the start tag that begins here.
std::size_t XmlDocument::skip_start_tag(std::size_t position) {
    char quotation = 0;
    const std::size_t limit = std::min(content_.size(), position + most_tag_bytes);
    for (std::size_t end = position + 1; end < limit; ++end) {
        const char c = content_[end];
        if (quotation != 0) {
            if (c == quotation) quotation = 0;
        } else if (c == '"' || c == '\'') {
            quotation = c;
        } else if (c == '>') {
            const std::size_t name_end = content_.find_first_of(" \t\r\n/>", position + 1);
            tags_.push_back(
                {position, end + 1, content_.substr(position + 1, name_end - position - 1)});
            return end + 1;
        }
    }
    throw input_error_at(location(position), limit == content_.size()
                                                 ? "begins a tag that never ends"
                                                 : "begins a tag longer than 64 KiB; must be "
                                                   "shorter");
}

/// Finds the start tags, and refuses what parse() shall not see.
void XmlDocument::scan() {
    int depth = 0;
    std::size_t position = 0;
    while ((position = content_.find('<', position)) != std::string::npos) {
        const std::string_view rest = std::string_view(content_).substr(position);
        if (rest.starts_with("<!--")) {
            position = find_end(position, "-->", "a comment");
        } else if (rest.starts_with("<![CDATA[")) {
            position = find_end(position, "]]>", "a CDATA section");
        } else if (rest.starts_with("<?")) {
            position = find_end(position, "?>", "a declaration");
        } else if (rest.starts_with("<!")) {
            throw input_error_at(location(position),
                                 "declares a document type or an entity; must have none");
        } else if (rest.starts_with("</")) {
            position = find_end(position, ">", "a tag");
            --depth;
        } else {
            const std::size_t end = skip_start_tag(position);
            if (content_[end - 2] != '/' && ++depth > most_depth) {
                throw input_error_at(location(position),
                                     "is nested more than 50 deep; must be less");
            }
            position = end;
        }
    }
}

void XmlDocument::parse() {
    document_.Parse(content_.data(), content_.size());
    if (document_.Error()) {
        const std::string name = document_.ErrorName();  // XML_ERROR_MISMATCHED_ELEMENT
        std::string words = name.starts_with("XML_ERROR_") ? name.substr(10) : name;
        std::replace(words.begin(), words.end(), '_', ' ');
        std::transform(words.begin(), words.end(), words.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        throw input_error_at({path_, document_.ErrorLineNum()},
                             "is not XML: " + words + "; correct it there or just before");
    }
    if (document_.RootElement() == nullptr) {
        throw input_error_at({path_}, "is not XML: it has no element");
    }
    number(root());
    if (const auto* second = root().NextSiblingElement()) {
        throw input_error_at({path_, second->GetLineNum()},
                             "is not XML: a second root element begins; must be one");
    }
    if (tag_of_.size() != tags_.size()) {
        throw input_error_at({path_}, "is not XML: its tags do not match");
    }
}

/// Elements in the order of the file are the start tags in the order of the file.
void XmlDocument::number(const tinyxml2::XMLElement& element) {
    const std::size_t index = tag_of_.size();
    if (index >= tags_.size() || tags_[index].name != element.Name()) {
        throw input_error_at({path_, element.GetLineNum()}, "is not XML: its tags do not match");
    }
    tag_of_.emplace(&element, index);
    for (auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
        number(*child);
    }
}

const StartTag& XmlDocument::tag(const tinyxml2::XMLElement& element) const {
    return tags_[tag_of_.at(&element)];
}

InputError XmlDocument::error(const tinyxml2::XMLElement& element,
                              const std::string& problem) const {
    return input_error_at(location(element), problem);
}

}  // namespace posewise::io
