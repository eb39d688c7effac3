#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "posewise/measurement/campaign.hpp"

namespace posewise::io {

/// Keys stay in the order they were written, so equal content is equal bytes.
using Json = nlohmann::ordered_json;

/// The beginning of every file we write: what it is and which version wrote it.
Json make_document(const std::string& kind);

/// Writes the document, each number with as many digits as it takes to read it back exactly; what
/// is infinite or unknown becomes null. Throws InputError if a text is not UTF-8.
void write_json(const std::string& path, const Json& document);

/// Reads a document of that kind. Throws InputError for anything else, and for a key that stands
/// twice.
Json read_document(const std::string& path, const std::string& kind);

/// Whether a file says of itself that it is of that kind. Throws InputError if it cannot be read.
bool is_document_of(const std::string& path, const std::string& kind);

/// `_rad` or `_m`.
std::string si_suffix(bool is_angle);

/// The key of the torque or force under which a compliance's value is what gives way.
const char* load_key(bool turns);

Json vector_to_json(const Vector3d& vector);

/// What a campaign assumes: noise, model error and the expected error of each parameter.
Json assumptions_to_json(const Campaign& campaign);

}  // namespace posewise::io
