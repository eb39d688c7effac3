#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "posewise/task/answers.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::detail {

/// Keys stay in the order they were written, so equal content is equal bytes.
using Json = nlohmann::ordered_json;

/// The beginning of every document we write: what it is, which version wrote it, the format of what
/// follows, and no warnings.
Json make_document(const std::string& kind);

/// The document as text, each number with as many digits as it takes to read it back exactly; what
/// is infinite or unknown becomes null. Throws InputError, which names the place it is for, if a
/// text in it is not UTF-8.
std::string json_text(const Json& document, const std::string& place = "standard output");
/// The same without line breaks.
std::string json_line(const Json& document, const std::string& place);
void write_json(const std::string& path, const Json& document);

/// Reads JSON, which should be what is said: "plan or estimate". Throws InputError for anything
/// else than JSON, and for a key that stands twice.
Json read_json(const std::string& path, const std::string& what);

/// Reads a document of that kind. Throws InputError for anything else, for another format than
/// make_document() writes, and for a key that stands twice.
Json read_document(const std::string& path, const std::string& kind);
/// The same of what the file at that path would hold.
Json parse_document(const std::string& content, const std::string& path, const std::string& kind);

/// `_rad` or `_m`.
std::string si_suffix(const AmountUnits& units);
inline std::string si_suffix(bool is_angle) { return si_suffix(units_of(is_angle)); }
/// `_mrad` or `_mm`: of small errors, a thousand to the SI unit.
std::string error_suffix(const AmountUnits& units);
inline std::string error_suffix(bool is_angle) { return error_suffix(units_of(is_angle)); }

/// The key of the torque or force under which a compliance's value is what gives way.
const char* load_key(bool turns);

/// A length in mm; null if there is none.
Json millimetres(const std::optional<double>& metres);

Json vector_to_json(const Eigen::Ref<const VectorXd>& vector);

/// A list of `key`, `question` and `text`.
Json answers_to_json(const std::vector<Answer>& answers);

/// An object of them; "expected_error/dq2_rad" is dq2_rad of the object expected_error (a JSON
/// pointer without the first slash).
Json numbers_to_json(const std::vector<NamedNumber>& numbers);

}  // namespace posewise::detail
