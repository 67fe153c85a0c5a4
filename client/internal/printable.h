// Foreign text in messages and names. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_PRINTABLE_H_
#define LATVOX_CLIENT_INTERNAL_PRINTABLE_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns the text with an escape, such as \x1b, in place of each control character and of each byte that is not UTF-8.
std::string Printable(absl::string_view text);

// Returns the text with the replacement character, U+FFFD, in place of each byte that is not UTF-8.
std::string ValidUtf8(absl::string_view text);

// Does as Printable with the message of a status, and keeps its code and its details.
absl::Status PrintableStatus(const absl::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_PRINTABLE_H_
