// A foreign server's answers, as the SDK takes them: of a surface, of a band, and of voxels with attributes.
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "client/internal/answer_check.h"

namespace {

// Answers, each behind its length in two bytes. The length 0xFFFF has no answer: the stream broke, and another
// one goes on.
void Take(const uint8_t* data, size_t size, const std::optional<latvox::client::Band>& band,
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
  Take(data, size, std::nullopt, {});
  Take(data, size, latvox::client::Band{.width = 1, .is_signed = true}, {});
  Take(data, size, std::nullopt, {latvox::client::Attribute::kColor, latvox::client::Attribute::kPart});
  return 0;
}
