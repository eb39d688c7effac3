#include "yaml_reader.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include "text.hpp"

namespace posewise::detail {
namespace {

FileLocation locate(const std::string& path, const YAML::Mark& mark) {
    if (mark.is_null()) return {path};
    return {path, mark.line + 1, mark.column + 1};
}

std::string describe(const YAML::Node& node) {
    if (node.IsMap()) return "is a map";
    if (node.IsSequence()) return "is a list";
    if (node.IsScalar()) return "is " + quote(node.Scalar());
    return "has no value";
}

/// `sigma_mm` with each unit of length, other keys as they are.
std::vector<std::string> spell_out_units(const std::vector<std::string>& keys) {
    std::vector<std::string> spelled;
    for (const std::string& key : keys) {
        const NameWithUnit name = split_unit(key);
        if (name.unit == nullptr) {
            spelled.push_back(key);
            continue;
        }
        for (const std::string& unit : unit_names(name.unit->quantity)) {
            spelled.push_back(fmt::format("{}_{}", name.stem, unit));
        }
    }
    return spelled;
}

/// Whether the word occurs in the sentence.
bool names_word(std::string_view sentence, std::string_view word) {
    const auto is_letter = [](char c) { return c == '_' || (c >= 'a' && c <= 'z'); };
    for (auto at = sentence.find(word); at != std::string_view::npos;
         at = sentence.find(word, at + 1)) {
        const auto end = at + word.size();
        if ((at == 0 || !is_letter(sentence[at - 1])) &&
            (end == sentence.size() || !is_letter(sentence[end]))) {
            return true;
        }
    }
    return false;
}

/// The advice after an unknown key; one that only lacks its unit gets the usual unit.
std::string suggest_key(const std::string& unknown, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        const NameWithUnit name = split_unit(key);
        if (name.unit != nullptr && name.stem == unknown) return suggest(key, {key});
    }
    return suggest(unknown, keys);
}

/// Whether a line of the file begins with a tab, or with spaces and a tab.
bool is_indented_by_tab(const std::string& content, const YAML::Mark& mark) {
    if (mark.is_null()) return false;
    std::size_t begin = 0;
    for (int line = 0; line < mark.line && begin < content.size(); ++line) {
        begin = std::min(content.find('\n', begin), content.size() - 1) + 1;
    }
    const std::size_t end = content.find_first_not_of(" \t", begin);
    return content.substr(begin, end - begin).find('\t') != std::string::npos;
}

/// UTF-16, which begins with a byte order mark, is left to the parser.
void check_utf8(const std::string& content, const std::string& path) {
    if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF")) return;
    const std::size_t at = find_not_utf8(content);
    if (at == std::string::npos) return;
    const auto end = content.begin() + static_cast<std::ptrdiff_t>(at);
    const auto line = 1 + std::count(content.begin(), end, '\n');
    const std::size_t begin = at == 0 ? std::string::npos : content.rfind('\n', at - 1);
    const std::size_t column = begin == std::string::npos ? at + 1 : at - begin;
    throw input_error_at({path, static_cast<long>(line), static_cast<long>(column)},
                         "is not UTF-8 text here; must be UTF-8 (or plain ASCII)");
}

/// Where the documents of a text begin.
class DocumentStarts : public YAML::EventHandler {
  public:
    const std::vector<YAML::Mark>& marks() const { return marks_; }

    void OnDocumentStart(const YAML::Mark& mark) override { marks_.push_back(mark); }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
    void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
    void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  const std::string&) override {}
    void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                         YAML::EmitterStyle::value) override {}
    void OnSequenceEnd() override {}
    void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                    YAML::EmitterStyle::value) override {}
    void OnMapEnd() override {}

  private:
    std::vector<YAML::Mark> marks_;
};

}  // namespace

YamlValue::YamlValue(YAML::Node node, FileLocation location, std::string name)
    : node_(std::move(node)), location_(std::move(location)), name_(std::move(name)) {}

InputError YamlValue::error(const std::string& problem) const {
    return input_error_at(location_, (name_.empty() ? "the file" : name_) + " " + problem);
}

std::string YamlValue::text() const {
    if (!node_.IsScalar()) throw error(describe(node_) + "; must be text");
    return node_.Scalar();
}

FileLocation YamlValue::text_location() const {
    FileLocation location = location_;
    if (node_.Tag() == "!") ++location.column;  // quoted
    return location;
}

double YamlValue::number(const std::string& or_else) const {
    if (!node_.IsScalar()) throw error(describe(node_) + "; must be a number" + or_else);
    const ParsedNumber number = parse_number(node_.Scalar());
    if (!number.ok()) {
        throw error(describe(node_) + ", which " + std::string(number.problem) +
                    "; must be a finite number without unit" + or_else);
    }
    return number.value;
}

std::uint64_t YamlValue::natural_number(std::uint64_t least, std::uint64_t most,
                                        const std::string& what) const {
    const std::string digits = node_.IsScalar() ? node_.Scalar() : "";
    std::uint64_t number = 0;
    const auto [end, problem] =
        std::from_chars(digits.data(), digits.data() + digits.size(), number);
    const std::string range = fmt::format("from {} to {}{}", least, most, what);
    if (problem != std::errc() || end != digits.data() + digits.size()) {
        throw error(describe(node_) + "; must be a whole number " + range);
    }
    if (number < least || number > most) {
        throw error(fmt::format("is {}; must be {}", number, range));
    }
    return number;
}

bool YamlValue::boolean(const std::string& or_else) const {
    const std::string word = node_.IsScalar() ? node_.Scalar() : "";
    if (word != "true" && word != "false") {
        throw error(describe(node_) + "; must be true or false" + or_else);
    }
    return word == "true";
}

std::vector<YamlValue> YamlValue::list() const {
    if (!node_.IsSequence()) throw error(describe(node_) + "; must be a list");
    std::vector<YamlValue> items;
    for (const YAML::Node& item : node_) {
        items.emplace_back(item, locate(location_.path, item.Mark()),
                           name_ + "[" + std::to_string(items.size() + 1) + "]");
    }
    return items;
}

std::vector<double> YamlValue::numbers(std::size_t count) const {
    const std::vector<YamlValue> items = list();
    if (items.size() != count) {
        throw error("has " + std::to_string(items.size()) + " values; must have " +
                    std::to_string(count));
    }
    std::vector<double> values;
    for (const YamlValue& item : items) values.push_back(item.number());
    return values;
}

std::vector<YamlEntry> YamlValue::entries() const {
    if (!node_.IsMap()) throw error(describe(node_) + "; must be a map of keys and values");
    std::vector<YamlEntry> entries;
    std::map<std::string, long> lines;
    for (const auto& pair : node_) {
        const YAML::Node key = pair.first;
        const YAML::Node value = pair.second;
        const FileLocation location = locate(location_.path, key.Mark());
        if (!key.IsScalar()) throw input_error_at(location, "a key must be text");
        const auto [first, is_new] = lines.emplace(key.Scalar(), location.line);
        if (!is_new) {
            throw input_error_at(location, "key " + quote(key.Scalar()) +
                                               " occurs twice, first in line " +
                                               std::to_string(first->second) + "; keep one");
        }
        const bool is_placed = !value.IsNull() && !value.Mark().is_null();
        entries.push_back(
            {key.Scalar(), location,
             YamlValue(value, is_placed ? locate(location_.path, value.Mark()) : location,
                       name_.empty() ? key.Scalar() : name_ + "." + key.Scalar())});
    }
    return entries;
}

double YamlMeasure::to_si() const {
    const double si = unit->to_si(value.number());
    if (!is_plausible(si, unit->quantity)) {
        throw value.error("is " + quote(value.text()) + "; must be " + plausible(*unit));
    }
    return si;
}

VectorXd YamlMeasure::list_to_si(std::size_t count) const {
    value.numbers(count);
    VectorXd si(static_cast<Index>(count));
    Index k = 0;
    for (const YamlValue& item : value.list()) si[k++] = YamlMeasure{item, unit}.to_si();
    return si;
}

Vector3d YamlMeasure::vector_to_si() const { return list_to_si(3); }

std::vector<std::string> YamlKeys::of(std::string_view map) const {
    std::vector<std::string> found;
    for (const YamlKey& key : keys) {
        if (map.empty() || key.of.empty() || names_word(key.of, map)) found.emplace_back(key.key);
    }
    return found;
}

YamlMap::YamlMap(const YamlValue& value, const std::vector<std::string>& keys)
    : value_(value), entries_(value.entries()), keys_(spell_out_units(keys)) {
    for (const YamlEntry& entry : entries_) {
        if (std::find(keys_.begin(), keys_.end(), entry.key) == keys_.end()) {
            const std::string where = value.name().empty() ? "" : " in " + value.name();
            throw input_error_at(entry.key_location, "unknown key " + quote(entry.key) + where +
                                                         "; " + suggest_key(entry.key, keys_));
        }
    }
}

std::optional<YamlValue> YamlMap::find(std::string_view key) const {
    for (const YamlEntry& entry : entries_) {
        if (entry.key == key) return entry.value;
    }
    return std::nullopt;
}

YamlValue YamlMap::require(std::string_view key) const {
    if (auto value = find(key)) return *value;
    throw missing({std::string(key)});
}

std::optional<YamlMeasure> YamlMap::find_measure(std::string_view stem) const {
    std::optional<YamlMeasure> measure;
    for (const YamlEntry& entry : entries_) {
        const NameWithUnit name = split_unit(entry.key);
        if (name.unit == nullptr || name.stem != stem) continue;
        if (measure) {
            throw input_error_at(entry.key_location,
                                 "'" + std::string(stem) + "' is stated in two units; keep one");
        }
        measure = YamlMeasure{entry.value, name.unit};
    }
    return measure;
}

YamlMeasure YamlMap::require_measure(std::string_view stem) const {
    if (auto measure = find_measure(stem)) return *measure;
    std::vector<std::string> alternatives;
    for (const std::string& key : keys_) {
        if (const auto name = split_unit(key); name.unit != nullptr && name.stem == stem) {
            alternatives.push_back(key);
        }
    }
    throw missing(alternatives);
}

InputError YamlMap::missing(const std::vector<std::string>& alternatives) const {
    return value_.error("has no key " + list_words(alternatives) + "; it must be stated");
}

std::optional<YamlValue> find_of(const YamlValue& map, std::string_view key) {
    if (!map.is_map()) return std::nullopt;
    for (const YamlEntry& entry : map.entries()) {
        if (entry.key == key) return entry.value;
    }
    return std::nullopt;
}

YamlValue require_of(const YamlValue& map, std::string_view key, std::string_view why) {
    if (auto value = find_of(map, key)) return *value;
    throw map.error(fmt::format("has no key '{}', {}", key, why));
}

YamlValue parse_yaml(const std::string& content, const std::string& path) {
    check_utf8(content, path);
    if (content.find('\r') < content.size() - 1 && content.find('\n') == std::string::npos) {
        throw input_error_at({path}, "has line ends of CR only; must be of LF or CR LF");
    }
    YAML::Node document;
    DocumentStarts starts;
    try {
        document = YAML::Load(content);
        std::istringstream stream(content);
        YAML::Parser parser(stream);
        // Not further: a comma where a document should begin would be one empty document after
        // another.
        if (parser.HandleNextDocument(starts)) parser.HandleNextDocument(starts);
    } catch (const YAML::Exception& problem) {
        throw input_error_at(locate(path, problem.mark),
                             is_indented_by_tab(content, problem.mark)
                                 ? "the line is indented by a tab; must be by spaces"
                                 : "is not YAML: " + escape_controls(problem.msg) +
                                       "; correct it there or just before");
    }
    if (document.IsNull()) {
        throw input_error_at({path}, "is empty, or begins with no key; must be a campaign in YAML");
    }
    if (starts.marks().size() > 1) {
        throw input_error_at(locate(path, starts.marks()[1]),
                             "a second document begins; must be one document");
    }
    return YamlValue(document, locate(path, document.Mark()), "");
}

}  // namespace posewise::detail
