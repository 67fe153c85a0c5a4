// Text in UTF-16.
#ifndef LATVOX_CLIENT_MESH_FILES_UTF16_H_
#define LATVOX_CLIENT_MESH_FILES_UTF16_H_

#include <string>

#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns the units as UTF-8. Half a pair of surrogates, and half a unit at the end, become the replacement character.
std::string Utf8OfUtf16(absl::string_view units, bool big_endian);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_UTF16_H_
