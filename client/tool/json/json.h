// JSON of the tool. The header of the library that does it costs each file 1.6 s of compilation: include this one only
// in a .cc, or in a header that passes values between the readers of glTF.
#ifndef LATVOX_CLIENT_TOOL_JSON_JSON_H_
#define LATVOX_CLIENT_TOOL_JSON_JSON_H_

#include <nlohmann/json.hpp>

namespace latvox::client {

using Json = nlohmann::ordered_json;  // members stand as they were added: what people read
using SortedJson = nlohmann::json;    // members stand by name: what was read from others

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_JSON_JSON_H_
