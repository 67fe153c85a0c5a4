#include "tests/faults/mutations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "latvox/v1/voxelizer.pb.h"
#include "tests/faults/good_scripts.h"
#include "tests/faults/raw_http2.h"

namespace latvox::faults {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr absl::Duration kLittle = absl::Milliseconds(300);

double AnyDouble(Chance& chance) {
  using Limits = std::numeric_limits<double>;
  constexpr double values[] = {0,
                               -0.0,
                               1,
                               -1,
                               Limits::max(),
                               Limits::lowest(),
                               Limits::min(),
                               1e-30,
                               1e30,
                               1e300,
                               0.01,
                               Limits::denorm_min(),
                               Limits::infinity(),
                               1e-9,
                               65536.,
                               -3.0e38,
                               1e7,
                               -Limits::infinity(),
                               Limits::quiet_NaN()};
  return chance.OneIn(3) ? chance.Between(-10, 10) : chance.Of(values);
}

uint64_t AnyInteger(Chance& chance) {
  constexpr uint64_t values[] = {0,           1, 2, 3, 7, 64, 65535, 65536, 65537, 1u << 31, ~0u, uint64_t{1} << 40,
                                 ~uint64_t{0}};
  return chance.OneIn(3) ? chance.Below(1000) : chance.Of(values);
}

// Changes or removes the value of a field. Appends to a repeated field.
void SetField(Message& message, const FieldDescriptor& field, Chance& chance) {
  const Reflection& reflection = *message.GetReflection();
  if (chance.OneIn(6)) return reflection.ClearField(&message, &field);
  const bool repeated = field.is_repeated();
  const auto put = [&](auto set, auto add, const auto& value) {
    (reflection.*(repeated ? add : set))(&message, &field, value);
  };
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return put(&Reflection::SetDouble, &Reflection::AddDouble, AnyDouble(chance));
    case FieldDescriptor::CPPTYPE_INT32:
      return put(&Reflection::SetInt32, &Reflection::AddInt32, static_cast<int32_t>(AnyInteger(chance)));
    case FieldDescriptor::CPPTYPE_UINT32:
      return put(&Reflection::SetUInt32, &Reflection::AddUInt32, static_cast<uint32_t>(AnyInteger(chance)));
    case FieldDescriptor::CPPTYPE_UINT64:
      return put(&Reflection::SetUInt64, &Reflection::AddUInt64, AnyInteger(chance));
    case FieldDescriptor::CPPTYPE_BOOL:
      return put(&Reflection::SetBool, &Reflection::AddBool, chance.OneIn(2));
    case FieldDescriptor::CPPTYPE_ENUM:
      return put(&Reflection::SetEnumValue, &Reflection::AddEnumValue, static_cast<int>(chance.Below(16)));
    case FieldDescriptor::CPPTYPE_STRING:
      return put(&Reflection::SetString, &Reflection::AddString, chance.Bytes(chance.Below(100)));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      static_cast<void>(repeated ? reflection.AddMessage(&message, &field)
                                 : reflection.MutableMessage(&message, &field));
      return;
    default:
      return;  // the protocol has no other types
  }
}

// Changes one field, anywhere in the tree of messages.
void MutateFields(Message& message, Chance& chance) {
  const auto& type = *message.GetDescriptor();
  if (type.field_count() == 0) return;
  const FieldDescriptor& field = *type.field(static_cast<int>(chance.Below(static_cast<uint64_t>(type.field_count()))));
  const Reflection& reflection = *message.GetReflection();
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !chance.OneIn(5)) {
    if (!field.is_repeated()) return MutateFields(*reflection.MutableMessage(&message, &field), chance);
    if (const int size = reflection.FieldSize(message, &field); size > 0) {
      const auto n = static_cast<int>(chance.Below(static_cast<uint64_t>(size)));
      return MutateFields(*reflection.MutableRepeatedMessage(&message, &field, n), chance);
    }
  }
  SetField(message, field, chance);
}

template <class Request>
void MutateMessage(std::string& bytes, Chance& chance) {
  Request request;
  if (!request.ParseFromString(bytes)) return;
  for (uint64_t n = 1 + chance.Below(3); n > 0; --n) MutateFields(request, chance);
  bytes = request.SerializeAsString();
}

void MutateMessageOf(const std::string& method, std::string& bytes, Chance& chance) {
  if (method.ends_with("UploadMesh")) return MutateMessage<v1::UploadMeshRequest>(bytes, chance);
  if (method.ends_with("VoxelizeStored")) return MutateMessage<v1::VoxelizeStoredRequest>(bytes, chance);
  if (method.ends_with("VoxelizeSmall")) return MutateMessage<v1::VoxelizeSmallRequest>(bytes, chance);
  if (method.ends_with("PutMesh")) return MutateMessage<v1::PutMeshRequest>(bytes, chance);
  if (method.ends_with("Pixelize")) return MutateMessage<v1::PixelizeRequest>(bytes, chance);
  if (method.ends_with("Voxelize")) return MutateMessage<v1::VoxelizeRequest>(bytes, chance);
  bytes = chance.Bytes(chance.Below(20));  // GetLimits has no fields
}

void MutateOrder(Script& script, Chance& chance) {
  std::vector<std::string>& messages = script.messages;
  switch (chance.Below(6)) {
    case 0:
      messages.erase(messages.begin() + static_cast<ptrdiff_t>(chance.Below(messages.size())));
      break;
    case 1: {
      const std::string again = chance.Of(messages);
      messages.insert(messages.begin() + static_cast<ptrdiff_t>(chance.Below(messages.size() + 1)), again);
      break;
    }
    case 2:
      std::swap(chance.Of(messages), chance.Of(messages));
      break;
    case 3:
      messages.resize(chance.Below(messages.size()) + 1);
      break;
    case 4:
      messages.insert(messages.begin() + static_cast<ptrdiff_t>(chance.Below(messages.size() + 1)), std::string());
      break;
    default:
      script.half_close = false;
      break;
  }
}

void AppendVarint(uint32_t value, std::string& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<char>(value | 0x80));
  bytes.push_back(static_cast<char>(value));
}

}  // namespace

Script MutatedScript(const std::string& drc, Chance& chance) {
  Script script = GoodScript(chance.OneIn(3) ? MutatedBytes(drc, chance) : drc, chance);
  script.timeout = kLittle;
  // Mostly mutates the specification, because a mesh is mostly a single field.
  const auto any_message = [&]() -> std::string& {
    return chance.OneIn(3) ? chance.Of(script.messages) : script.messages.front();
  };
  for (uint64_t n = 1 + chance.Below(2); n > 0 && !script.messages.empty(); --n) {
    switch (chance.Below(6)) {
      case 0: {
        std::string& message = any_message();
        message = MutatedBytes(message, chance);
        break;
      }
      case 1:
        MutateOrder(script, chance);
        break;
      default:
        MutateMessageOf(script.method, any_message(), chance);
        break;
    }
  }
  return script;
}

std::string MutatedBytes(std::string bytes, Chance& chance) {
  for (uint64_t n = 1 + chance.Below(4); n > 0 && !bytes.empty(); --n) {
    const size_t at = chance.Below(bytes.size()), length = std::min<size_t>(bytes.size() - at, 1 + chance.Below(16));
    switch (chance.Below(6)) {
      case 0:
        bytes.erase(at, length);
        break;
      case 1:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 2:
        bytes.insert(at, chance.Bytes(length));
        break;
      case 3:
        bytes.replace(at, length, std::string(length, chance.OneIn(2) ? '\xff' : '\0'));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << chance.Below(8)));
        break;
    }
  }
  return bytes;
}

std::string MutatedConnection(const Script& script, Chance& chance) {
  std::string call = CallHeaders(1, script.method);
  for (size_t n = 0; n < script.messages.size(); ++n) {
    if (script.messages[n].size() < 16000) call += MessageFrame(1, script.messages[n], n + 1 == script.messages.size());
  }
  // The preface alone decides whether anything else is read.
  return chance.OneIn(8) ? MutatedBytes(Preface() + call, chance) : Preface() + MutatedBytes(call, chance);
}

std::string DracoWithHugeCounts(bool edgebreaker, size_t size, Chance& chance) {
  std::string bytes = "DRACO";
  bytes += {2, 2, 1, static_cast<char>(edgebreaker ? 1 : 0), 0, 0};  // version 2.2, a mesh, no flags
  if (edgebreaker) bytes.push_back(0);                               // standard traversal
  const uint32_t huge[] = {1u << 24, 1u << 26, 1u << 28, 1u << 30, ~0u, 60'000'000, 3u << 24};
  for (int counts = edgebreaker ? 5 : 2; counts > 0; --counts) AppendVarint(chance.Of(huge), bytes);
  while (bytes.size() < size) bytes.push_back(static_cast<char>(chance.OneIn(4) ? chance.Below(256) : 0));
  return bytes;
}

}  // namespace latvox::faults
