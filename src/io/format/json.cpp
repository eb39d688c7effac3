#include "json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "atomic_file.hpp"
#include "core/text.hpp"
#include "file_kind.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/core/version.hpp"
#include "text.hpp"

namespace posewise::detail {
namespace {

constexpr int most_deep = 50;  // copying and destroying are recursive

/// Line and column of a byte, counted from 1.
FileLocation locate(const std::string& path, const std::string& content, std::size_t byte) {
    const std::string before = content.substr(0, byte > 0 ? byte - 1 : 0);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto line_begin = before.rfind('\n');
    const std::size_t column =
        line_begin == std::string::npos ? before.size() : before.size() - line_begin - 1;
    return {path, static_cast<long>(line), static_cast<long>(column) + 1};
}

/// Indented, but a list of plain values on one line: a matrix reads as one.
void append_json(const Json& value, const std::string& indent, std::string& text) {
    const bool is_plain_list =
        value.is_array() && std::none_of(value.begin(), value.end(),
                                         [](const Json& item) { return item.is_structured(); });
    if (!value.is_structured() || value.empty() || is_plain_list) {
        text += value.dump();
        return;
    }
    const std::string deeper = indent + "  ";
    text += value.is_object() ? '{' : '[';
    const char* separator = "\n";
    for (const auto& [key, item] : value.items()) {
        text += separator + deeper;
        if (value.is_object()) text += Json(key).dump() + ": ";
        append_json(item, deeper, text);
        separator = ",\n";
    }
    text += '\n' + indent + (value.is_object() ? '}' : ']');
}

/// What `write` gives; it throws as Json::dump() does.
template <class Write>
std::string write_text(const std::string& place, Write&& write) {
    try {
        return write();
    } catch (const Json::type_error&) {  // the only one dump() has
        throw input_error_at({place},
                             "cannot be written, since a name or id is not UTF-8 text; "
                             "must be UTF-8 (or plain ASCII)");
    }
}

/// Notes the first key that an object has twice, of which a parser would keep one silently.
class RepeatedKey {
  public:
    /// As a callback of Json::parse().
    bool operator()(Json::parse_event_t event, const Json& parsed) {
        if (event == Json::parse_event_t::object_start) keys_.emplace_back();
        if (event == Json::parse_event_t::object_end) keys_.pop_back();
        if (event == Json::parse_event_t::key) {
            const auto key = parsed.get<std::string>();
            if (!keys_.back().insert(key).second && !key_) key_ = key;
        }
        return true;
    }
    const std::optional<std::string>& key() const { return key_; }

  private:
    std::vector<std::set<std::string>> keys_;  // of the objects that are open
    std::optional<std::string> key_;
};

/// The format that we write and read of a kind of document. It grows by one when a key is renamed,
/// removed or means something else.
int format_of(const std::string& kind) { return kind == "plan" ? 2 : 1; }

}  // namespace

Json make_document(const std::string& kind) {
    Json document;
    document["kind"] = "posewise " + kind;
    document["posewise_version"] = version;
    document["format"] = format_of(kind);
    document["warnings"] = Json::array();
    return document;
}

std::string json_text(const Json& document, const std::string& place) {
    return write_text(place, [&] {
        std::string text;
        append_json(document, "", text);
        return text + '\n';
    });
}

std::string json_line(const Json& document, const std::string& place) {
    return write_text(place, [&] { return document.dump(); });
}

void write_json(const std::string& path, const Json& document) {
    write_file(path, json_text(document, path));
}

namespace {

Json parse_json(const std::string& content, const std::string& path, const std::string& what) {
    check_file_kind(content, path, FileKind::Document,
                    with_article(what) + " as posewise writes it");
    Json document;
    RepeatedKey repeated;
    try {
        document = Json::parse(content, [&](int depth, Json::parse_event_t event,
                                            const Json& parsed) {
            if (depth > most_deep) {
                throw input_error_at({path}, "is nested more than " + std::to_string(most_deep) +
                                                 " deep; must be less");
            }
            return repeated(event, parsed);
        });
    } catch (const Json::parse_error& problem) {
        const auto location =
            content.empty() ? FileLocation{path} : locate(path, content, problem.byte);
        throw input_error_at(
            location, "is not JSON here; must be " + with_article(what) + " as posewise writes it");
    } catch (const Json::exception&) {  // a number that overflows; it has no place
        throw input_error_at({path}, "has a number beyond the range of numbers; must be " +
                                         with_article(what) + " as posewise writes it");
    }
    if (repeated.key()) {
        throw input_error_at({path}, "key " + quote(*repeated.key()) +
                                         " stands twice in one object; must stand once");
    }
    return document;
}

}  // namespace

Json read_json(const std::string& path, const std::string& what) {
    return parse_json(read_file(path), path, what);
}

Json read_document(const std::string& path, const std::string& kind) {
    return parse_document(read_file(path), path, kind);
}

Json parse_document(const std::string& content, const std::string& path, const std::string& kind) {
    const int format = format_of(kind);
    Json document = parse_json(content, path, kind);
    const auto found = document.is_object() ? document.find("kind") : document.end();
    if (found == document.end() || *found != "posewise " + kind) {
        throw input_error_at({path}, "kind: must be \"posewise " + kind + "\", as in " +
                                         with_article(kind) + " written by posewise");
    }
    const auto stated = document.find("format");
    if (stated == document.end()) {
        throw input_error_at({path}, fmt::format("has no key format; must be {}, as posewise "
                                                 "writes it",
                                                 format));
    }
    if (*stated != format) {
        throw input_error_at({path}, fmt::format("format: is {}; this posewise reads {}: make the "
                                                 "{} again with it",
                                                 stated->dump(), format, kind));
    }
    return document;
}

std::string si_suffix(const AmountUnits& units) {
    return units.si.empty() ? "" : '_' + std::string(units.si);
}

std::string error_suffix(const AmountUnits& units) { return '_' + std::string(units.error); }

const char* load_key(bool turns) { return turns ? "at_Nm" : "at_N"; }

Json millimetres(const std::optional<double>& metres) {
    return metres ? Json(mm_per_m * *metres) : Json(nullptr);
}

Json vector_to_json(const Eigen::Ref<const VectorXd>& vector) {
    return std::vector<double>(vector.begin(), vector.end());
}

Json answers_to_json(const std::vector<Answer>& answers) {
    Json list = Json::array();
    for (const Answer& one : answers) {
        list.push_back({{"key", one.key}, {"question", one.question}, {"text", one.text}});
    }
    return list;
}

Json numbers_to_json(const std::vector<NamedNumber>& numbers) {
    Json flat = Json::object();
    for (const NamedNumber& one : numbers) flat['/' + one.name] = one.value;
    return flat.unflatten();
}

}  // namespace posewise::detail
