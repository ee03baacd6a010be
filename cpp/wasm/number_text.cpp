// The texts of numbers in messages, by the page: JavaScript has what the tables of the C++ library would take a quarter
// of the module for. These are the two functions of <charconv> that base/messages.hpp calls.
#include <charconv>

extern "C" __attribute__((import_module("page"), import_name("number_text"))) int page_number_text(double value,
                                                                                                   int digits,
                                                                                                   char* text);

namespace std {
inline namespace _LIBCPP_ABI_NAMESPACE {

to_chars_result to_chars(char* first, char*, double value) {
    return {first + page_number_text(value, 0, first), errc{}};
}

to_chars_result to_chars(char* first, char*, double value, chars_format, int digits) {
    return {first + page_number_text(value, digits, first), errc{}};
}

}  // namespace _LIBCPP_ABI_NAMESPACE
}  // namespace std
