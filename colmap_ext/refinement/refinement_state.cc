#include "colmap_ext/refinement/refinement_state.h"

#include <charconv>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

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

constexpr const char* kStartAnew = "; start anew, without --resume";

// Shortest form that is read back as the same number.
std::string Text(double number) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof(text), number);
  return {text, end};
}

// The size of a file and its bytes' hash (FNV-1a, 64 bits), or "none".
std::string Fingerprint(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) {
    return "none";
  }
  uint64_t hash = 0xcbf29ce484222325;
  uint64_t size = 0;
  std::vector<char> buffer(1 << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())),
         file.gcount() > 0) {
    const auto count = static_cast<size_t>(file.gcount());
    for (size_t i = 0; i < count; ++i) {
      hash = (hash ^ static_cast<uint8_t>(buffer[i])) * 0x100000001b3;
    }
    size += count;
  }
  char text[64];
  std::snprintf(text, sizeof(text), "%llu bytes, hash %016llx",
                static_cast<unsigned long long>(size),
                static_cast<unsigned long long>(hash));
  return text;
}

void WriteSteps(const RefinementReport& report, std::ostream& stream) {
  for (const LabelingReport& labeling : report.labelings) {
    stream << "labeling " << labeling.level << " " << labeling.num_pairs << " "
           << labeling.num_unlabeled_facets << " "
           << Text(labeling.initial_energy) << " "
           << Text(labeling.final_energy) << " " << Text(labeling.lower_bound)
           << "\n";
  }
  for (const RefinementStep& step : report.steps) {
    stream << "step " << step.level << " " << step.is_final << " "
           << step.iteration << " " << Text(step.energy) << " "
           << Text(step.photometric_energy) << " " << Text(step.mean_zncc)
           << " " << Text(step.mean_step) << " " << Text(step.seconds) << " "
           << step.num_vertices << " " << step.num_facets << "\n";
  }
}

std::string StateText(const RunIdentity& identity, const RefinementState& state,
                      const fs::path& mesh_path, const fs::path& origin_path) {
  std::ostringstream stream;
  for (const auto& [name, value] : identity) {
    stream << name << " " << value << "\n";
  }
  stream << "level " << state.level << "\n"
         << "mesh " << Fingerprint(mesh_path) << "\n"
         << "visibility " << Fingerprint(VisibilityPath(mesh_path)) << "\n"
         << "origin " << Fingerprint(origin_path) << "\n"
         << "shortened_steps " << state.report.num_shortened_steps << "\n"
         << "flipped_facets " << state.report.num_flipped_facets << "\n";
  WriteSteps(state.report, stream);
  stream << "end\n";
  return stream.str();
}

// Reads a state's lines.
class StateReader {
 public:
  explicit StateReader(const fs::path& path) : path_(path), file_(path) {}

  // The rest of the next line, which has to start so.
  std::string Take(const std::string& name) {
    std::string line;
    std::getline(file_, line);
    if (!line.starts_with(name + " ")) {
      Throw();
    }
    return line.substr(name.size() + 1);
  }

  size_t TakeCount(const std::string& name) {
    size_t count = 0;
    Parse(Take(name), &count);
    return count;
  }

  // Labelings and steps up to the end.
  void TakeSteps(RefinementReport* report) {
    for (std::string line; std::getline(file_, line);) {
      if (line == "end") {
        return;
      }
      std::istringstream items(line);
      std::string name;
      items >> name;
      if (name == "labeling") {
        LabelingReport& labeling = report->labelings.emplace_back();
        TakeNumbers(items, &labeling.level, &labeling.num_pairs,
                    &labeling.num_unlabeled_facets, &labeling.initial_energy,
                    &labeling.final_energy, &labeling.lower_bound);
      } else if (name == "step") {
        RefinementStep& step = report->steps.emplace_back();
        int is_final = 0;
        TakeNumbers(items, &step.level, &is_final, &step.iteration,
                    &step.energy, &step.photometric_energy, &step.mean_zncc,
                    &step.mean_step, &step.seconds, &step.num_vertices,
                    &step.num_facets);
        step.is_final = is_final != 0;
      } else {
        Throw();
      }
    }
    Throw();
  }

  [[noreturn]] void Throw() const {
    throw FileError(path_, std::string("damaged") + kStartAnew);
  }

  [[noreturn]] void ThrowOther(const std::string& name,
                               const std::string& before,
                               const std::string& now) const {
    throw FileError(path_, "belongs to another run: " + name + " was '" +
                               before + "' and is '" + now +
                               "'; go on as it was begun, or start anew, "
                               "without --resume");
  }

 private:
  template <typename Number>
  void Parse(const std::string& text, Number* number) {
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, *number);
    if (error != std::errc() || end != last) {
      Throw();
    }
  }

  template <typename... Numbers>
  void TakeNumbers(std::istream& items, Numbers*... numbers) {
    const auto take = [&](auto* number) {
      std::string item;
      items >> item;
      Parse(item, number);
    };
    (take(numbers), ...);
  }

  fs::path path_;
  std::ifstream file_;
};

void ReadLevelMesh(const fs::path& path, const fs::path& origin_path,
                   RefinementState* state) {
  ColoredMesh read = ReadColoredPlyMesh(path);
  Visibility visibility =
      ReadVisibility(VisibilityPath(path), read.mesh.vertices.size(),
                     {"mesh", "start anew, without --resume"});
  state->mesh = std::move(read.mesh);
  state->attributes = {std::move(read.colors), std::move(visibility)};
  state->origins = ReadPlyMesh(origin_path).vertices;
}

void RemoveLevelMesh(const fs::path& output, int level) {
  std::error_code ignored;
  const fs::path path = LevelMeshPath(output, level);
  fs::remove(path, ignored);
  fs::remove(VisibilityPath(path), ignored);
  fs::remove(LevelOriginPath(output, level), ignored);
}

}  // namespace

RunIdentity IdentityOf(const RefinerOptions& options,
                       const RefinementPaths& paths) {
  const FacetwiseRefinementOptions& refinement = options.refinement;
  return {
      {"colmap_ext_facetwise_refiner_state", "2"},
      {"--input_path", Fingerprint(paths.mesh)},
      {"--input_path.vis", Fingerprint(VisibilityPath(paths.mesh))},
      {"fused.ply.vis", Fingerprint(paths.folder / "fused.ply.vis")},
      {"levels", std::to_string(refinement.levels)},
      {"iterations", std::to_string(refinement.iterations)},
      {"window", std::to_string(options.window)},
      {"noise_variance", Text(refinement.photometric.noise_variance)},
      {"residual_floor", Text(refinement.photometric.residual_floor)},
      {"min_cosine", Text(refinement.photometric.min_cosine)},
      {"smoothness_weight", Text(refinement.smoothness_weight)},
      {"max_face_area", Text(refinement.max_face_area)},
      {"pairs_per_image", std::to_string(refinement.pairs_per_image)},
      {"pairs_per_facet", std::to_string(refinement.labeling.pairs_per_facet)},
      {"final_pairs_per_facet",
       std::to_string(refinement.labeling.final_pairs_per_facet)},
      {"potts_weight", Text(refinement.labeling.potts_weight)},
      {"pair_selection", options.pair_selection},
      {"occlusion_masking",
       std::to_string(int{refinement.photometric.occlusion_masking})},
      {"solver", options.solver},
      {"skip_missing_images", std::to_string(int{options.skip_missing_images})},
  };
}

fs::path StatePath(const fs::path& output) {
  return output.string() + ".resume";
}

fs::path LevelMeshPath(const fs::path& output, int level) {
  return fs::path(output).replace_extension(".level" + std::to_string(level) +
                                            ".ply");
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
  WriteMesh(mesh_path, state.mesh, state.attributes);
  const fs::path origin_path = LevelOriginPath(output, state.level);
  WriteColoredMesh(origin_path, {state.origins, state.mesh.facets}, {});
  WriteText(StatePath(output),
            StateText(identity, state, mesh_path, origin_path));
  RemoveLevelMesh(output, state.level + 1);
}

RefinementState ReadState(const fs::path& output, const RunIdentity& identity) {
  const fs::path path = StatePath(output);
  ExpectRegularFile(path);
  StateReader reader(path);
  for (const auto& [name, value] : identity) {
    if (const std::string before = reader.Take(name); before != value) {
      reader.ThrowOther(name, before, value);
    }
  }
  RefinementState state;
  state.level = static_cast<int>(reader.TakeCount("level"));
  const fs::path mesh_path = LevelMeshPath(output, state.level);
  const fs::path origin_path = LevelOriginPath(output, state.level);
  const std::pair<const char*, fs::path> files[] = {
      {"mesh", mesh_path},
      {"visibility", VisibilityPath(mesh_path)},
      {"origin", origin_path}};
  for (const auto& [name, file] : files) {
    if (reader.Take(name) != Fingerprint(file)) {
      throw FileError(
          file,
          std::string("is not what the interrupted run wrote") + kStartAnew);
    }
  }
  state.report.num_shortened_steps = reader.TakeCount("shortened_steps");
  state.report.num_flipped_facets = reader.TakeCount("flipped_facets");
  reader.TakeSteps(&state.report);
  ReadLevelMesh(mesh_path, origin_path, &state);
  return state;
}

void RemoveState(const fs::path& output, int level) {
  std::error_code ignored;
  fs::remove(StatePath(output), ignored);
  RemoveLevelMesh(output, level);
}

}  // namespace colmap_ext
