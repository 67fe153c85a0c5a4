#include "client/grid/voxel_file.h"

#include <blosc.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <openvdb/version.h>

#include <array>
#include <atomic>
#include <exception>
#include <ios>
#include <memory>
#include <mutex>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "client/grid/file_uuid.h"
#include "client/grid/grid_frame.h"
#include "client/grid/new_file.h"
#include "client/grid/tree_survey.h"

namespace latvox::client {
namespace {

#ifndef OPENVDB_USE_BLOSC
#error OpenVDB must read files that are compressed by Blosc
#endif

// As OpenVDB writes files unless a program asks for something else: by Blosc, 4, and values of active tiles alone, 2.
constexpr uint32_t kCompression = 4 | 2;
constexpr char kCompressionText[] = "blosc + active values", kTreeType[] = "Tree_bool_5_4_3";

template <class T>
void Put(const T& value, std::string& out) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void PutText(const std::string& text, std::string& out) {
  Put(static_cast<uint32_t>(text.size()), out);
  out += text;
}

void PutMetadata(const Metadata& metadata, std::string& out) {
  Put(static_cast<uint32_t>(metadata.size()), out);
  for (const auto& [name, value] : metadata) {
    for (const std::string* text : {&name, &value.type, &value.bytes}) PutText(*text, out);
  }
}

// The values of `count` tiles, each of them true, as OpenVDB compresses them.
std::string PackedTiles(uint32_t count) {
  const std::string values(count, '\1');
  std::string packed(count + BLOSC_MAX_OVERHEAD, '\0');
  const int bytes = blosc_compress_ctx(/*clevel=*/9, /*doshuffle=*/1, /*typesize=*/sizeof(float), count, values.data(),
                                       packed.data(), packed.size(), BLOSC_LZ4_COMPNAME, /*blocksize=*/count,
                                       /*numinternalthreads=*/1);
  if (bytes <= 0) throw std::runtime_error("Blosc cannot compress values");
  packed.resize(static_cast<size_t>(bytes));
  std::string out(1, '\0');
  Put(int64_t{bytes}, out);
  return out + packed;
}

template <class Mask>
void PutNode(const Mask& children, const Mask& tiles, std::string& out) {
  static const auto* const none = new std::string(PackedTiles(0));
  out.append(children.data(), Mask::kBytes);
  out.append(tiles.data(), Mask::kBytes);
  const uint32_t count = tiles.Count();
  out += count == 0 ? *none : PackedTiles(count);
}

// The same nodes, until the call is cancelled. The first pass writes nothing, so no stream looks at the cancellation.
class StoppableNodes final : public LowerNodes {
 public:
  StoppableNodes(LowerNodes& nodes, const Cancellation& cancellation) : nodes_(nodes), cancellation_(cancellation) {}

  void Rewind() override { nodes_.Rewind(); }

  std::shared_ptr<const LowerNode> Next() override {
    if (cancellation_.cancelled()) throw std::ios_base::failure("cancelled");
    return nodes_.Next();
  }

 private:
  LowerNodes& nodes_;
  const Cancellation& cancellation_;
};

class Writer {
 public:
  Writer(const TreeSurvey& survey, LowerNodes& nodes, std::ostream& file)
      : survey_(survey), nodes_(nodes), file_(file) {}

  void Write(Metadata metadata, const std::string& transform) {
    WriteHeader();
    std::string front;
    Put(uint32_t{0}, front);  // metadata of the file
    Put(int32_t{1}, front);   // grids
    PutText(metadata.at("name").bytes, front);
    PutText(kTreeType, front);
    PutText("", front);  // the grid that has its tree: itself
    Append(front);
    const auto places_at = file_.tellp();
    std::array<int64_t, 3> places{};  // of the grid, its leaves and its end
    AppendPlaces(places);
    places[0] = Place();
    AppendGridFront(std::move(metadata), transform);
    AppendNodes([this](const LowerNode& node) { return Topology(node); });
    places[1] = Place();
    AppendNodes([](const LowerNode& node) { return Buffers(node); });
    places[2] = Place();
    file_.seekp(places_at);
    AppendPlaces(places);
    file_.seekp(kUuidAt);
    file_ << uuid_.Text();
  }

 private:
  void WriteHeader() {
    std::string header;
    Put(kVdbMagic, header);
    Put(uint32_t{openvdb::OPENVDB_FILE_VERSION}, header);
    Put(uint32_t{OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER}, header);
    Put(uint32_t{OPENVDB_LIBRARY_MINOR_VERSION_NUMBER}, header);
    Put(char{1}, header);  // the places of grids follow
    header.resize(kUuidAt + kUuidBytes);
    file_ << header;
  }

  void Append(const std::string& bytes) {
    uuid_.Add(bytes.data(), bytes.size());
    file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  void AppendPlaces(const std::array<int64_t, 3>& places) {
    std::string bytes;
    Put(places, bytes);
    Append(bytes);
  }

  int64_t Place() { return static_cast<int64_t>(file_.tellp()); }

  void AppendGridFront(Metadata metadata, const std::string& transform) {
    metadata["file_compression"] = ToMetadata(kCompressionText);
    for (auto& [name, value] : survey_.Statistics()) metadata[name] = value;
    std::string front;
    Put(kCompression, front);
    PutMetadata(metadata, front);
    front += transform;
    Put(int32_t{1}, front);  // buffers
    Put(false, front);       // background
    std::string tiles;
    uint32_t count = 0;
    for (const auto& [corner, upper] : survey_.uppers()) {
      if (!upper.is_full()) continue;
      ++count;
      Put(corner, tiles);
      Put(true, tiles);  // value
      Put(true, tiles);  // active
    }
    Put(count, front);
    Put(static_cast<uint32_t>(survey_.uppers().size()) - count, front);
    Append(front + tiles);
  }

  // Appends the bytes of all nodes, which a few threads make. Each pass appends the same nodes. oneTBB loses the memory
  // of what is in flight when a filter throws, so the first exception waits for the end.
  template <class Serialize>
  void AppendNodes(const Serialize& serialize) {
    constexpr size_t kAtOnce = 8;  // nodes of up to 576 KB
    using Node = std::shared_ptr<const LowerNode>;
    std::mutex mutex;
    std::exception_ptr failure;  // guarded by mutex
    std::atomic<bool> failed = false;
    const auto attempt = [&](const auto& work) {
      try {
        if (!failed) work();
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failed.exchange(true)) failure = std::current_exception();
      }
    };
    nodes_.Rewind();
    const auto take = [&](oneapi::tbb::flow_control& control) {
      Node node;
      attempt([&] { node = nodes_.Next(); });
      if (!node) control.stop();
      return node;
    };
    const auto make = [&](const Node& node) {
      std::string bytes;
      attempt([&] { bytes = serialize(*node); });
      return bytes;
    };
    const auto append = [&](const std::string& bytes) { attempt([&] { Append(bytes); }); };
    using oneapi::tbb::filter_mode;
    using oneapi::tbb::make_filter;
    oneapi::tbb::parallel_pipeline(kAtOnce, make_filter<void, Node>(filter_mode::serial_in_order, take) &
                                                make_filter<Node, std::string>(filter_mode::parallel, make) &
                                                make_filter<std::string, void>(filter_mode::serial_in_order, append));
    if (failure) std::rethrow_exception(failure);
  }

  // Returns a node's masks; before them, those of the upper node whose first one it is.
  std::string Topology(const LowerNode& node) const {
    std::string out;
    const UpperShape& upper = survey_.uppers().at(node.upper);
    if (upper.is_full()) return out;
    if (node.number == upper.first) {
      Put(node.upper, out);
      PutNode(upper.children, upper.tiles, out);
    }
    if (node.is_full()) return out;
    PutNode(node.leaves(), node.tiles(), out);
    node.ForEachLeaf([&out](uint32_t, const BrickMask& mask) { Put(mask, out); });
    return out;
  }

  static std::string Buffers(const LowerNode& node) {
    std::string out;
    TreePlace place{node.upper, node.number};
    node.ForEachLeaf([&](uint32_t number, const BrickMask& mask) {
      place.brick = number;
      Vec3i corner = BrickAt(place);
      for (int32_t& x : corner) x *= 8;
      Put(mask, out);
      Put(corner, out);
      Put(mask, out);
    });
    return out;
  }

  const TreeSurvey& survey_;
  LowerNodes& nodes_;
  std::ostream& file_;
  FileUuid uuid_;
};

}  // namespace

absl::Status WriteVoxelFile(LowerNodes& nodes, const std::string& transform, const DescribeVoxels& describe,
                            const std::string& path, const Cancellation& cancellation) {
  return WriteNewFile(path, cancellation, [&](std::ostream& file) {
    StoppableNodes stoppable(nodes, cancellation);
    const TreeSurvey survey(stoppable);
    Writer(survey, stoppable, file).Write(describe(survey.counts()), transform);
  });
}

}  // namespace latvox::client
