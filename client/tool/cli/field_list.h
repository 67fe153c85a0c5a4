// Lists of fields as words of options: "part,distance", or "none".
#ifndef LATVOX_CLIENT_TOOL_CLI_FIELD_LIST_H_
#define LATVOX_CLIENT_TOOL_CLI_FIELD_LIST_H_

#include <string>
#include <vector>

#include "deploy/manual/option_row.h"
#include "latvox/fields.h"

namespace latvox::client {

// Refuses other names, one that is given twice, and none beside a field.
WrongWord CheckFieldList(const std::string& text);

// Precondition: CheckFieldList accepts the text.
std::vector<Field> ParseFieldList(const std::string& text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_FIELD_LIST_H_
