#include "core/plane/cover.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/base/sort.h"
#include "core/plane/crossing2.h"

namespace latvox {
namespace {

constexpr uint32_t kOutside = std::numeric_limits<uint32_t>::max();

// A pixel of the set, as its index, and the other end of one of its crossed links.
struct Incidence {
  uint32_t pixel, other;  // other: an index, or kOutside
  bool operator<(const Incidence& b) const { return std::tie(pixel, other) < std::tie(b.pixel, b.other); }
};

uint32_t IndexOf(const std::vector<Vec2i>& pixels, const Vec2i& ij) {
  const auto found = std::lower_bound(pixels.begin(), pixels.end(), ij);
  return found != pixels.end() && *found == ij ? static_cast<uint32_t>(found - pixels.begin()) : kOutside;
}

// Returns the incidences sorted by pixel. Counts links without an end in the set in `uncovered` instead.
std::vector<Incidence> IncidencesOf(const std::vector<PlaneLink>& links, const std::vector<Vec2i>& pixels,
                                    uint64_t& uncovered, StopSignal stop) {
  std::vector<Incidence> incidences;
  uncovered = 0;
  for (const PlaneLink& link : links) {
    if (stop.Stopped()) break;
    const uint32_t low = IndexOf(pixels, link.low), high = IndexOf(pixels, link.high);
    if (low != kOutside) incidences.push_back({low, high});
    if (high != kOutside) incidences.push_back({high, low});
    if (low == kOutside && high == kOutside) ++uncovered;
  }
  Sort(incidences, stop);
  return incidences;
}

// Calls f(pixel, essential) for every pixel, in order: essential if it alone covers one of its links.
template <class F>
void ForEachPixel(const std::vector<Incidence>& incidences, const std::vector<bool>& member, F f) {
  auto next = incidences.begin();
  for (uint32_t pixel = 0; pixel < member.size(); ++pixel) {
    bool essential = false;
    for (; next != incidences.end() && next->pixel == pixel; ++next) {
      essential |= next->other == kOutside || !member[next->other];
    }
    f(pixel, essential);
  }
}

}  // namespace

PlaneCrossings FindCrossings(const std::vector<Segment>& segments, const std::vector<PlaneFrame>& frames,
                             StopSignal stop) {
  PlaneCrossings crossings;
  // Memory follows the distinct crossings, not the segments: duplicates leave before the lists double.
  size_t limit = 1 << 20;
  for (const Segment& segment : segments) {
    if (stop.Stopped()) return {};
    for (const PlaneFrame& frame : frames) {
      ForEachCrossing(segment, frame, [&](const Vec2i& nearer, const Vec2i& farther) {
        crossings.links.push_back({std::min(nearer, farther), std::max(nearer, farther)});
        crossings.nearer.push_back(nearer);
      });
    }
    if (crossings.links.size() < limit) continue;
    SortUnique(crossings.links, stop);
    SortUnique(crossings.nearer, stop);
    limit = std::max(limit, 2 * crossings.links.size());
  }
  SortUnique(crossings.links, stop);
  SortUnique(crossings.nearer, stop);
  return crossings;
}

void Thin(const std::vector<PlaneLink>& links, std::vector<Vec2i>& pixels, StopSignal stop) {
  uint64_t uncovered;
  const std::vector<Incidence> incidences = IncidencesOf(links, pixels, uncovered, stop);
  std::vector<bool> member(pixels.size(), true);
  for (int32_t parity = 0; parity < 4 && !stop.Stopped(); ++parity) {
    ForEachPixel(incidences, member, [&](uint32_t pixel, bool essential) {
      const Vec2i& ij = pixels[pixel];
      if (((ij[0] & 1) << 1 | (ij[1] & 1)) == parity && !essential) member[pixel] = false;
    });
  }
  size_t kept = 0;
  for (size_t pixel = 0; pixel < pixels.size(); ++pixel) {
    if (member[pixel]) pixels[kept++] = pixels[pixel];
  }
  pixels.resize(kept);
}

PlaneVerdict Judge(const std::vector<PlaneLink>& links, const std::vector<Vec2i>& pixels, StopSignal stop) {
  PlaneVerdict verdict;
  const std::vector<Incidence> incidences = IncidencesOf(links, pixels, verdict.tunnels, stop);
  ForEachPixel(incidences, std::vector<bool>(pixels.size(), true), [&](uint32_t, bool essential) {
    if (!essential) ++verdict.redundant;
  });
  return verdict;
}

}  // namespace latvox
