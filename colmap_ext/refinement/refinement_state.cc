#include "colmap_ext/refinement/refinement_state.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/refinement/file_fingerprint.h"
#include "colmap_ext/refinement/resume_file.h"
#include "formats/atomic_file.h"
#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/read_ply_mesh.h"
#include "formats/read_visibility.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

// Images take about 100 bytes each, iterations 300.
constexpr uint64_t kMaxResumeBytes = 1 << 26;
constexpr const char* kStartAnew = "; start anew, without --resume";

std::string ReadText(const fs::path& path) {
  ByteReader reader(path);
  if (reader.Remaining() > kMaxResumeBytes) {
    throw FileError(path, std::string("damaged: too large") + kStartAnew);
  }
  std::string text(reader.Remaining(), ' ');
  reader.Read(text.data(), text.size(), "the text");
  return text;
}

[[noreturn]] void ThrowOtherRun(const fs::path& path, const std::string& name,
                                const std::string& before,
                                const std::string& now) {
  throw FileError(
      path, fmt::format("belongs to another run: {} was '{}' and is '{}'; go "
                        "on as it was begun, or start anew, without --resume",
                        name, before, now));
}

void ExpectSameRun(const RunIdentity& before, const RunIdentity& identity,
                   const fs::path& path) {
  // Names that are no UTF-8 are not written as they are.
  const RunIdentity now =
      ParseResumeText(ResumeText({identity, 1, "", "", "", "", {}, {}}), path)
          .identity;
  for (size_t i = 0; i < std::min(before.size(), now.size()); ++i) {
    if (before[i].first != now[i].first) {
      ThrowOtherRun(path, "what it depends on", before[i].first, now[i].first);
    }
    if (before[i].second != now[i].second) {
      ThrowOtherRun(path, now[i].first, before[i].second, now[i].second);
    }
  }
  if (before.size() != now.size()) {
    ThrowOtherRun(path, "the number of its files and options",
                  std::to_string(before.size()), std::to_string(now.size()));
  }
}

void ExpectUnchanged(const fs::path& path, const std::string& fingerprint) {
  if (Fingerprint(path) != fingerprint) {
    throw FileError(path, std::string("is not what the interrupted run wrote") +
                              kStartAnew);
  }
}

constexpr VisibilityOwner kLevelMesh = {"mesh", "start anew, without --resume",
                                        std::nullopt};

// A row of one value for each vertex that stays, of none for the others.
Rows<uint32_t> RowsOf(const FixedSources& sources) {
  Rows<uint32_t> rows;
  for (const uint32_t source : sources) {
    if (source != kNone) {
      rows.values.push_back(source);
    }
    rows.EndRow();
  }
  return rows;
}

FixedSources SourcesFrom(const Rows<uint32_t>& rows) {
  FixedSources sources;
  for (size_t i = 0; i < rows.size(); ++i) {
    sources.push_back(rows[i].empty() ? kNone : rows[i].front());
  }
  return sources;
}

void WriteLevelMesh(const fs::path& path, const fs::path& origin_path,
                    const RefinementState& state) {
  WriteMesh(path, state.mesh, state.attributes);
  const TriangleMesh origins{state.origins, state.mesh.facets};
  if (state.fixed_sources.empty()) {
    WriteColoredMesh(origin_path, origins, {});
  } else {
    WriteMesh(origin_path, origins, {{}, RowsOf(state.fixed_sources)});
  }
}

void ReadLevelMesh(const fs::path& path, const fs::path& origin_path,
                   RefinementState* state) {
  ColoredMesh read = ReadColoredPlyMesh(path);
  const size_t num_vertices = read.mesh.vertices.size();
  Visibility visibility =
      ReadVisibility(VisibilityPath(path), num_vertices, kLevelMesh);
  state->mesh = std::move(read.mesh);
  state->attributes = {std::move(read.colors), std::move(visibility),
                       std::move(read.confidences)};
  state->origins = ReadPlyMesh(origin_path).vertices;
  if (fs::exists(VisibilityPath(origin_path))) {
    state->fixed_sources = SourcesFrom(
        ReadVisibility(VisibilityPath(origin_path), num_vertices, kLevelMesh));
  }
}

void RemoveLevelMesh(const fs::path& output, int level) {
  std::error_code ignored;
  const fs::path path = LevelMeshPath(output, level);
  fs::remove(path, ignored);
  fs::remove(VisibilityPath(path), ignored);
  fs::remove(LevelOriginPath(output, level), ignored);
  fs::remove(VisibilityPath(LevelOriginPath(output, level)), ignored);
}

}  // namespace

fs::path StatePath(const fs::path& output) {
  return output.string() + ".resume";
}

fs::path LevelMeshPath(const fs::path& output, int level) {
  return fs::path(output).replace_extension(fmt::format(".level{}.ply", level));
}

fs::path LevelOriginPath(const fs::path& output, int level) {
  return LevelMeshPath(output, level).replace_extension(".origin.ply");
}

void ExpectManifold(const TriangleMesh& mesh) {
  if (const MeshReport report = Analyze(mesh); !report.IsManifold()) {
    throw std::logic_error("the refined mesh has " + report.Defects());
  }
}

void WriteState(const fs::path& output, const RunIdentity& identity,
                const RefinementState& state) {
  ExpectManifold(state.mesh);
  const fs::path mesh_path = LevelMeshPath(output, state.level);
  const fs::path origin_path = LevelOriginPath(output, state.level);
  WriteLevelMesh(mesh_path, origin_path, state);
  WriteText(StatePath(output),
            ResumeText({identity, state.level, Fingerprint(mesh_path),
                        Fingerprint(VisibilityPath(mesh_path)),
                        Fingerprint(origin_path),
                        Fingerprint(VisibilityPath(origin_path)),
                        CameraNumbersOf(state.views), state.report}));
  RemoveLevelMesh(output, state.level + 1);
}

RefinementState ReadState(const fs::path& output, const RunIdentity& identity,
                          const std::vector<View>& views) {
  const fs::path path = StatePath(output);
  ResumeRecord record = ParseResumeText(ReadText(path), path);
  ExpectSameRun(record.identity, identity, path);
  const fs::path mesh_path = LevelMeshPath(output, record.level);
  const fs::path origin_path = LevelOriginPath(output, record.level);
  ExpectUnchanged(mesh_path, record.mesh);
  ExpectUnchanged(VisibilityPath(mesh_path), record.visibility);
  ExpectUnchanged(origin_path, record.origins);
  ExpectUnchanged(VisibilityPath(origin_path), record.fixed);
  RefinementState state;
  state.level = record.level;
  state.report = std::move(record.report);
  const std::optional<Misalignment>& misalignment = state.report.misalignment;
  if (record.cameras.size() != views.size() ||
      (misalignment && misalignment->by_view.size() != views.size())) {
    throw FileError(path, std::string("damaged: not of as many images as "
                                      "sparse/") +
                              kStartAnew);
  }
  state.views = WithCameraNumbers(views, record.cameras);
  ReadLevelMesh(mesh_path, origin_path, &state);
  return state;
}

void RemoveState(const fs::path& output, int level) {
  std::error_code ignored;
  fs::remove(StatePath(output), ignored);
  RemoveLevelMesh(output, level);
}

}  // namespace colmap_ext
