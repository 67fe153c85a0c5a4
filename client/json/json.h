// JSON of the tool, of grids and of the readers of meshes. The header underneath costs each file 1.6 s of compilation.
// So include this one only in a .cc, or in a header that passes values between the readers of glTF.
#ifndef LATVOX_CLIENT_JSON_JSON_H_
#define LATVOX_CLIENT_JSON_JSON_H_

#include <nlohmann/json.hpp>

namespace latvox::client {

using Json = nlohmann::ordered_json;  // keeps the order of addition, for output
using SortedJson = nlohmann::json;    // sorts by name, for input from others

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_JSON_JSON_H_
