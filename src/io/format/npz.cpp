#include <fmt/format.h>
#include <minizip/unzip.h>
#include <zlib.h>

#include <algorithm>
#include <climits>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "atomic_file.hpp"
#include "core/text.hpp"
#include "npy.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr std::string_view ending = ".npy";  // of the variables' names in the zip file

/// Whether so many bytes may be in a file of so many: as of MATLAB files, measured numbers are
/// packed to a tenth at best.
bool is_plausible(std::uint64_t unpacked, std::uint64_t packed) {
    constexpr std::uint64_t always = std::uint64_t{1} << 23;
    constexpr std::uint64_t never = std::uint64_t{1} << 30;
    return unpacked <= never && unpacked <= std::max(always, 50 * packed);
}

using ZipFile = std::unique_ptr<void, decltype(&unzClose)>;

InputError damage_error(const std::string& path) {
    return input_error_at({path}, "is damaged; must be a whole file as numpy.savez() writes it");
}

/// The name of the entry that the file is at.
std::string name_of_entry(const std::string& path, unzFile file, unz_file_info64& info) {
    std::string name(256, '\0');
    if (unzGetCurrentFileInfo64(file, &info, name.data(), name.size(), nullptr, 0, nullptr, 0) !=
        UNZ_OK) {
        throw damage_error(path);
    }
    name.resize(std::min<std::size_t>(info.size_filename, name.size()));
    return name;
}

/// Moves to the variable of that name, to the first if it is empty; returns its name.
std::string find_variable(const std::string& path, unzFile file, const std::string& variable,
                          unz_file_info64& info) {
    std::vector<std::string> names;
    for (int state = unzGoToFirstFile(file); state != UNZ_END_OF_LIST_OF_FILE;
         state = unzGoToNextFile(file)) {
        if (state != UNZ_OK) throw damage_error(path);
        std::string name = name_of_entry(path, file, info);
        if (!name.ends_with(ending)) continue;
        name.resize(name.size() - ending.size());
        if (variable.empty() || name == variable) return name;
        names.push_back(std::move(name));
    }
    if (names.empty()) throw input_error_at({path}, "has no variables; must have an array");
    throw input_error_at({path}, fmt::format("variable {} is not in the file; {}", quote(variable),
                                             suggest(variable, names)));
}

/// The whole entry that the file is at, unpacked.
std::string read_entry(const std::string& path, unzFile file, const unz_file_info64& info) {
    if (unzOpenCurrentFile(file) != UNZ_OK) throw damage_error(path);
    std::string content(info.uncompressed_size, '\0');
    std::size_t size = 0;
    while (size < content.size()) {
        const auto most =
            static_cast<unsigned>(std::min<std::size_t>(content.size() - size, 1 << 20));
        const int count = unzReadCurrentFile(file, content.data() + size, most);
        if (count <= 0) throw damage_error(path);
        size += static_cast<std::size_t>(count);
    }
    if (unzCloseCurrentFile(file) != UNZ_OK) throw damage_error(path);  // the sum is wrong
    return content;
}

void append_number(std::string& bytes, std::uint64_t number, int size) {
    for (int k = 0; k < size; ++k) bytes += static_cast<char>(number >> (8 * k));
}

}  // namespace

NpyArray read_npz(const std::string& path, const std::string& variable) {
    const std::uint64_t byte_count = read_file(path).size();  // says, too, why it cannot be read
    const ZipFile file(unzOpen64(path.c_str()), &unzClose);
    if (file == nullptr) {
        throw input_error_at(
            {path},
            "is not a file of NumPy's arrays, or damaged; must be as numpy.savez() writes it");
    }
    unz_file_info64 info{};
    const std::string subject =
        "variable " + quote(find_variable(path, file.get(), variable, info)) + ' ';
    constexpr unsigned encrypted = 1;
    if ((info.flag & encrypted) != 0) {
        throw input_error_at({path}, subject + "is encrypted; must be readable");
    }
    const std::uint64_t unpacked = info.uncompressed_size;
    if (!is_plausible(unpacked, byte_count)) {
        throw input_error_at(
            {path}, fmt::format("{}has {} B in a file of {} B; must be at most 1 GiB, packed at "
                                "most fiftyfold (numpy.savez() does not pack)",
                                subject, unpacked, byte_count));
    }
    return parse_npy(read_entry(path, file.get(), info), path, subject);
}

std::string npz_text(const std::string& variable, const std::string& npy) {
    const std::string name = variable + std::string(ending);
    const auto sum = static_cast<std::uint64_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(npy.data()), npy.size()));
    // What the entry's own header and the directory have in common: version 2.0, not packed, the
    // first day of 1980.
    std::string entry;
    for (const std::uint64_t number : {20U, 0U, 0U, 0U, 0x21U}) append_number(entry, number, 2);
    for (const std::uint64_t number : {sum, std::uint64_t{npy.size()}, std::uint64_t{npy.size()}}) {
        append_number(entry, number, 4);
    }
    append_number(entry, name.size(), 2);
    append_number(entry, 0, 2);
    std::string text = "PK\3\4" + entry + name + npy;
    const std::size_t directory = text.size();
    text += "PK\1\2";
    append_number(text, 20, 2);
    text += entry;
    text.append(14, '\0');  // no comment, the first disk, no attributes, at the file's beginning
    text += name;
    const std::size_t directory_size = text.size() - directory;
    text += "PK\5\6";
    for (const std::uint64_t number : {0U, 0U, 1U, 1U}) append_number(text, number, 2);
    append_number(text, directory_size, 4);
    append_number(text, directory, 4);
    append_number(text, 0, 2);
    return text;
}

}  // namespace posewise::detail
