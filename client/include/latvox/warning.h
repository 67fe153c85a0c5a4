// Doubts about a result, although there was no error.
#ifndef LATVOX_LATVOX_WARNING_H_
#define LATVOX_LATVOX_WARNING_H_

#include <string>

namespace latvox::client {

// One warning, for programs and for people.
struct Warning {
  std::string code;          // UPPER_SNAKE_CASE, for programs; client/docs/limits.md lists all codes
  std::string message;       // a sentence for people, which names the element
  std::string element = "";  // where: "line 7", "meshes[2]", "vertex 5"; empty: the whole
  bool operator==(const Warning&) const = default;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_WARNING_H_
