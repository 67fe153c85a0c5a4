// A foreign server's answers, as the SDK receives them: for a surface, for a band, and for voxels with attributes.
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "client/internal/answer_check.h"

namespace {

// Input: answers, each after its length in two bytes. The length 0xFFFF has no answer: the stream broke, and a new one
// continues.
void Receive(const uint8_t* data, size_t size, const std::optional<latvox::client::Band>& band,
             const std::vector<latvox::client::Attribute>& attributes) {
  latvox::client::VoxelizeHandlers handlers;
  handlers.on_bricks = [](const latvox::client::BrickBatch&) { return absl::OkStatus(); };
  latvox::client::AnswerCheck check(handlers, 1, band, attributes);
  while (size >= 2) {
    uint16_t length;
    std::memcpy(&length, data, 2);
    data += 2;
    size -= 2;
    if (length == 0xFFFF) {
      check.BeginStretch();
      continue;
    }
    if (length > size) length = static_cast<uint16_t>(size);
    latvox::v1::VoxelizeResponse answer;
    if (!answer.ParseFromArray(data, length) || !check.Receive(answer).ok()) return;
    data += length;
    size -= length;
  }
  (void)check.End();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Receive(data, size, std::nullopt, {});
  Receive(data, size, latvox::client::Band{.width = 1, .is_signed = true}, {});
  Receive(data, size, std::nullopt, {latvox::client::Attribute::kColor, latvox::client::Attribute::kPart});
  return 0;
}
