#include "page_template.hpp"

// An assembler puts the file in as it is, which takes no time and no tools; a compiler that reads a
// megabyte of numbers takes a minute. Nothing is read or copied when the program starts.
__asm__(
    ".pushsection .rodata\n"
    ".globl posewise_page_begin\n"
    ".hidden posewise_page_begin\n"
    ".globl posewise_page_end\n"
    ".hidden posewise_page_end\n"
    "posewise_page_begin:\n"
    ".incbin \"" POSEWISE_PAGE
    "\"\n"
    "posewise_page_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" {
[[gnu::visibility("hidden")]] extern const char posewise_page_begin[];
[[gnu::visibility("hidden")]] extern const char posewise_page_end[];
}

namespace posewise::detail {

std::string_view page_template() {
    return {posewise_page_begin, static_cast<std::size_t>(posewise_page_end - posewise_page_begin)};
}

}  // namespace posewise::detail
