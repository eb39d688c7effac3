#include "xml_document.hpp"

#include <algorithm>
#include <new>
#include <set>
#include <string_view>

#include "atomic_file.hpp"
#include "core/text.hpp"

namespace posewise::detail {
namespace {

using pugi::xml_node;

constexpr std::size_t most_bytes = std::size_t{4} << 20;
constexpr std::size_t most_tag_bytes = std::size_t{64} << 10;
constexpr int most_depth = 50;
constexpr const char* document_type = "declares a document type or an entity; must have none";

/// Taken as UTF-8, whatever it declares. All that stands beside the root element is kept, to be
/// judged, and so are line breaks in attributes.
pugi::xml_parse_result parse(pugi::xml_document& document, const std::string& content) {
    constexpr unsigned options = pugi::parse_fragment | pugi::parse_cdata | pugi::parse_comments |
                                 pugi::parse_declaration | pugi::parse_pi | pugi::parse_doctype |
                                 pugi::parse_escapes | pugi::parse_eol | pugi::parse_trim_pcdata;
    return document.load_buffer(content.data(), content.size(), options, pugi::encoding_utf8);
}

std::size_t offset_of(xml_node node) { return static_cast<std::size_t>(node.offset_debug()); }

/// The last one in the order of the text.
xml_node last_node(const pugi::xml_document& document) {
    xml_node node = document;
    while (node.last_child()) node = node.last_child();
    return node;
}

/// What is wrong at the '<' that `rest` begins with.
const char* problem_of(pugi::xml_parse_status status, std::string_view rest) {
    if (status == pugi::status_bad_start_element || status == pugi::status_bad_attribute) {
        return "begins a tag that is not XML; must be like <name a=\"1\" b=\"2\">";
    }
    if (rest.starts_with("<!--")) return "begins a comment that never ends";
    if (rest.starts_with("<![CDATA[")) return "begins a CDATA section that never ends";
    if (rest.starts_with("<!")) return document_type;
    if (rest.starts_with("<?")) {
        return "is not XML: a <?...?> must end with ?>, and <?xml must stand first";
    }
    if (status == pugi::status_bad_end_element) return "is not XML: an end tag must be </name>";
    return "is not XML: a '<' must begin a tag or be written &lt;";
}

}  // namespace

XmlDocument::XmlDocument(const std::string& path)
    : path_(path), content_(read_file(path, most_bytes)) {
    line_begins_.push_back(0);
    for (std::size_t k = 0; k < content_.size(); ++k) {
        if (content_[k] == '\n') line_begins_.push_back(k + 1);
    }
    if (const auto nul = content_.find('\0'); nul != std::string::npos) {
        throw input_error_at(location_at(nul), "has a NUL byte; must be text in UTF-8");
    }
    const pugi::xml_parse_result result = parse(document_, content_);
    collect_elements(document_, 1);  // up to the error, if there is one
    if (!result) throw parse_error(result);
    check_top_level();
    check_tags();
}

FileLocation XmlDocument::location_at(std::size_t position) const {
    const auto after = std::upper_bound(line_begins_.begin(), line_begins_.end(), position);
    return {path_, after - line_begins_.begin(), static_cast<long>(position - after[-1]) + 1};
}

FileLocation XmlDocument::location(xml_node element) const {
    return location_at(offset_of(element) - 1);
}

InputError XmlDocument::error(xml_node element, const std::string& problem) const {
    return input_error_at(location(element), problem);
}

StartTag XmlDocument::start_tag(xml_node element) const {
    StartTag tag{offset_of(element) - 1, offset_of(element)};
    for (char quotation = 0; quotation != 0 || content_[tag.end - 1] != '>'; ++tag.end) {
        const char c = content_[tag.end];
        if (quotation != 0) {
            if (c == quotation) quotation = 0;
        } else if (c == '"' || c == '\'') {
            quotation = c;
        }
    }
    return tag;
}

void XmlDocument::collect_elements(xml_node parent, int depth) {
    for (const xml_node node : parent.children()) {
        if (node.type() != pugi::node_element) continue;
        if (depth > most_depth) throw error(node, "is nested more than 50 deep; must be less");
        elements_.push_back(node);
        collect_elements(node, depth + 1);
    }
}

/// The parser lets pass what a well-formed document has not.
void XmlDocument::check_top_level() const {
    for (const xml_node node : document_.children()) {
        const std::size_t begin = content_.rfind('<', offset_of(node) - 1);
        switch (node.type()) {
            case pugi::node_doctype:
                throw input_error_at(location_at(begin), document_type);
            case pugi::node_pcdata:
            case pugi::node_cdata:
                throw input_error_at(location_at(offset_of(node)),
                                     "is not XML: text outside of the root element");
            case pugi::node_declaration:
                if (node == document_.first_child()) break;
                throw input_error_at(location_at(begin), problem_of(pugi::status_bad_pi, "<?"));
            case pugi::node_element:
                if (node == root()) break;
                throw error(node, "is not XML: a second root element begins; must be one");
            default:
                break;
        }
    }
    if (!root()) throw input_error_at({path_}, "is not XML: it has no element");
}

void XmlDocument::check_tags() const {
    for (const xml_node element : elements_) {
        const StartTag tag = start_tag(element);
        if (tag.end - tag.begin > most_tag_bytes) {
            throw error(element, "begins a tag longer than 64 KiB; must be shorter");
        }
        std::set<std::string_view> names;
        for (const pugi::xml_attribute attribute : element.attributes()) {
            if (names.insert(attribute.name()).second) continue;
            throw error(element, std::string("is not XML: a second attribute ") +
                                     quote(attribute.name()) + " in one <" + element.name() +
                                     ">; must be one");
        }
    }
}

InputError XmlDocument::parse_error(const pugi::xml_parse_result& result) const {
    const auto offset = static_cast<std::size_t>(result.offset);
    const bool is_at_end = offset + 1 >= content_.size();
    std::size_t begin = content_.rfind('<', is_at_end ? offset : offset - 1);
    switch (result.status) {
        case pugi::status_out_of_memory:
            throw std::bad_alloc();
        case pugi::status_end_element_mismatch:
            // A closed tag before the end of the file is not what is wrong.
            if (is_at_end && content_.find('>', begin) != std::string::npos) {
                begin = content_.size();
            }
            return mismatch_error(begin);
        case pugi::status_bad_start_element:
        case pugi::status_bad_attribute:
            begin = content_.rfind('<', offset_of(last_node(document_)));
            break;
        case pugi::status_bad_doctype:
            begin = content_.rfind("<!", offset);
            break;
        case pugi::status_bad_pi:
            begin = content_.rfind("<?", offset);
            break;
        default:
            break;
    }
    return input_error_at(location_at(begin),
                          problem_of(result.status, std::string_view(content_).substr(begin)));
}

/// An end tag, or the end of the file, that does not close what is open there.
InputError XmlDocument::mismatch_error(std::size_t end_tag) const {
    pugi::xml_document with_child;  // of the open element, whose last node it is
    parse(with_child, content_.substr(0, end_tag) + "<child/>");
    const xml_node open = last_node(with_child).parent();
    const FileLocation place = location_at(end_tag);
    if (open.type() != pugi::node_element) {
        return input_error_at(place, "is not XML: an end tag without a start tag");
    }
    const std::string name = std::string("<") + open.name() + '>';
    return error(open,
                 "is not XML: " + name +
                     (end_tag == content_.size() ? " is never closed"
                                                 : " is not closed before the end tag in line " +
                                                       std::to_string(place.line)));
}

}  // namespace posewise::detail
