// Prints measurements as a line of text, or as JSON.
#ifndef LATVOX_TESTS_BENCH_PRINT_H_
#define LATVOX_TESTS_BENCH_PRINT_H_

#include <string>

#include "tests/bench/arguments.h"
#include "tests/bench/measure.h"

namespace latvox {

std::string ToText(const Measurement& measurement);
std::string ToJson(const Arguments& arguments, const Measurement& measurement);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PRINT_H_
