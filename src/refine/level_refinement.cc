#include "refine/level_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "mesh/facet_normals.h"
#include "mesh/vertex_normals.h"
#include "mesh/vertex_rings.h"
#include "refine/normal_equations.h"
#include "refine/relief.h"
#include "refine/smoothness_weights.h"
#include "refine/thin_plate.h"

namespace colmap_ext {

namespace {

// Of the energy, that an iteration has to gain for another one to follow.
constexpr double kMinGain = 2e-4;

// Px, that the vertices may have moved on average before the mesh is drawn
// again.
constexpr double kMaxDrift = 0.1;

// Of the smoothness, before anything is known of the surface.
constexpr double kFirstWeight = 20;

// Iterations of the finest level without regard to the relief that the mesh
// was given with.
constexpr int kBlindIterations = 2;

// Iterations by all labels, after those by the few.
constexpr int kFinalIterations = 2;

// Of the conjugate gradients.
constexpr double kTolerance = 0.03;
constexpr int kMaxIterations = 100;

// A surface with what its energy is.
struct Surface {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3f> normals;  // [V]
  PhotometricTerms terms;
  ThinPlate plate;

  double Energy() const { return terms.energy + plate.Energy(); }
};

class LevelRefiner {
 public:
  LevelRefiner(const FacetwiseRefinementOptions& options, int level,
               const FacetLabels& labels, const std::vector<View>& views,
               const std::vector<Eigen::Vector3f>& origins,
               PhotometricEnergy* energy, const TriangleMesh& mesh)
      : options_(options),
        level_(level),
        weight_(kFirstWeight * options.smoothness_weight),
        weights_(mesh.vertices.size(), weight_),
        labels_(labels),
        few_labels_(labels.First(options.labeling.pair_selection ==
                                         PairSelection::kClassical
                                     ? SIZE_MAX
                                     : options.labeling.pairs_per_facet)),
        energy_(energy),
        rings_(MakeVertexRings(mesh)) {
    surface_.mesh = mesh;
    surface_.normals = VertexNormals(mesh, rings_);
    FindFootprints(views);
    Draw();
    FindSeen();
    CountPixels();
    FindRest(origins);
    surface_.plate = PlateOf(surface_);
  }

  void Run(const OnLevelStep& on_step, TriangleMesh* mesh) {
    if (Report(0, on_step, mesh) &&
        Iterate(options_.iterations, on_step, mesh) &&
        few_labels_.labels.values.size() < labels_.labels.values.size()) {
      is_final_ = true;
      Draw();
      CountPixels();
      surface_.plate = PlateOf(surface_);
      if (Report(0, on_step, mesh)) {
        Iterate(kFinalIterations, on_step, mesh);
      }
    }
  }

  size_t NumShortenedSteps() const { return num_shortened_steps_; }

 private:
  Surface WithPlate(TriangleMesh mesh, PhotometricTerms terms) const {
    Surface surface;
    surface.normals = VertexNormals(mesh, rings_);
    surface.mesh = std::move(mesh);
    surface.terms = std::move(terms);
    surface.plate = PlateOf(surface);
    return surface;
  }

  ThinPlate PlateOf(const Surface& surface) const {
    return MakeThinPlate(weights_, surface.mesh.vertices, surface.normals,
                         rings_, footprints_, num_pixels_, rest_);
  }

  // So often at most; whether to go on.
  bool Iterate(int max_iterations, const OnLevelStep& on_step,
               TriangleMesh* mesh) {
    for (int i = 0; i < max_iterations; ++i) {
      if (drift_ > kMaxDrift) {
        Draw();
      }
      if (level_ == 0 && weight_ > 0) {
        if (iteration_ >= kBlindIterations) {
          AskForConfirmedRelief();
        }
        EstimateWeights();
      }
      const double before = surface_.Energy();
      const double step = Step();
      if (!(step > 0)) {
        break;
      }
      ++iteration_;
      drift_ += step;
      if (!Report(step, on_step, mesh)) {
        return false;
      }
      if (before - surface_.Energy() < kMinGain * std::abs(before)) {
        break;
      }
    }
    return true;
  }

  void Draw() {
    drift_ = 0;
    energy_->Render(surface_.mesh);
    surface_.terms = energy_->Evaluate(surface_.mesh, LabelsInUse());
  }

  const FacetLabels& LabelsInUse() const {
    return is_final_ ? labels_ : few_labels_;
  }

  void FindFootprints(const std::vector<View>& views);
  void FindSeen();
  void CountPixels();
  void FindRest(const std::vector<Eigen::Vector3f>& origins);
  void AskForConfirmedRelief();
  void EstimateWeights();
  std::vector<double> SolveForMotion() const;
  void LimitMotion(std::vector<double>* motion) const;
  TriangleMesh Move(std::vector<double>* motion);
  double Step();
  bool Report(double step, const OnLevelStep& on_step,
              TriangleMesh* mesh) const;

  const FacetwiseRefinementOptions& options_;
  int level_;
  double weight_;                // of the smoothness, on the whole
  std::vector<double> weights_;  // [V]
  const FacetLabels& labels_;
  FacetLabels few_labels_;  // before the final iterations
  PhotometricEnergy* energy_;
  VertexRings rings_;
  std::vector<float> footprints_;  // [V] of a pixel, scene units
  std::vector<uint8_t> is_seen_;   // [V] from the beginning
  std::vector<float> num_pixels_;  // [V] see ThinPlate
  std::vector<double> rest_;       // [V] see ThinPlate
  // [V] trusted, that the mesh was given with; 0 for what is not seen. At the
  // finest level.
  std::vector<double> relief_;
  Surface surface_;
  int iteration_ = 0;
  bool is_final_ = false;
  double drift_ = 0;  // px, since the mesh was drawn
  size_t num_shortened_steps_ = 0;
};

// In the views of the best pairs around a vertex; the median of all where there
// are none.
void LevelRefiner::FindFootprints(const std::vector<View>& views) {
  const TriangleMesh& mesh = surface_.mesh;
  footprints_.assign(mesh.vertices.size(), 0);
  std::vector<float> known;
  for (size_t i = 0; i < footprints_.size(); ++i) {
    const Eigen::Vector3d point = mesh.vertices[i].cast<double>();
    double sum = 0;
    int count = 0;
    for (const uint32_t corner : rings_.corners[i]) {
      const auto labels = labels_.labels[corner / 3];
      if (labels.empty()) {
        continue;
      }
      const ViewPair& pair = labels_.pairs[labels.front()];
      for (const uint32_t view : {pair.first, pair.second}) {
        sum += views[view].CamFromWorld(point).z() / views[view].fx;
        ++count;
      }
    }
    if (count > 0) {
      footprints_[i] = static_cast<float>(sum / count);
      known.push_back(footprints_[i]);
    }
  }
  if (known.empty()) {
    return;
  }
  const auto median = known.begin() + static_cast<ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), median, known.end());
  for (float& footprint : footprints_) {
    if (!(footprint > 0)) {
      footprint = *median;
    }
  }
}

void LevelRefiner::FindSeen() {
  const TriangleMesh& mesh = surface_.mesh;
  is_seen_.assign(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    if (surface_.terms.num_pixels[i] > 0) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_seen_[vertex] = 1;
      }
    }
  }
}

// Those compared, in both directions of all pairs, or those that the facets
// cover, if that is more: large facets of which little is compared would have
// next to no stiffness else, and the noise of a few pixels raise them to tents.
void LevelRefiner::CountPixels() {
  const TriangleMesh& mesh = surface_.mesh;
  num_pixels_.assign(mesh.vertices.size(), 0);
  std::vector<float> areas(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a];
    const Eigen::Vector3f ac = mesh.vertices[c] - mesh.vertices[a];
    const float area = ab.cross(ac).norm() / 2;
    for (const uint32_t vertex : mesh.facets[i]) {
      num_pixels_[vertex] += surface_.terms.num_pixels[i] / 3;
      areas[vertex] += area / 3;
    }
  }
  for (size_t i = 0; i < num_pixels_.size(); ++i) {
    if (footprints_[i] > 0) {
      num_pixels_[i] = std::max(num_pixels_[i],
                                areas[i] / (footprints_[i] * footprints_[i]));
    }
  }
}

void LevelRefiner::FindRest(const std::vector<Eigen::Vector3f>& origins) {
  const TriangleMesh& mesh = surface_.mesh;
  rest_ = Relief(mesh, rings_, footprints_);
  if (level_ > 0) {
    return;
  }
  relief_ = TrustedRelief({origins, mesh.facets}, rings_, footprints_);
  for (size_t i = 0; i < rest_.size(); ++i) {
    (is_seen_[i] != 0 ? rest_ : relief_)[i] = 0;
  }
}

void LevelRefiner::AskForConfirmedRelief() {
  const ThinPlate& plate = surface_.plate;
  std::vector<double> importance(rest_.size());
  std::vector<double> surface(rest_.size());
  for (size_t i = 0; i < rest_.size(); ++i) {
    importance[i] = plate.coefficients[i] / weights_[i];
    surface[i] = plate.residuals[i] + rest_[i];
  }
  const std::vector<double> shares =
      ReliefShares(rings_, importance, relief_, surface);
  for (size_t i = 0; i < rest_.size(); ++i) {
    if (is_seen_[i] != 0) {
      rest_[i] = shares[i] * relief_[i];
    }
  }
}

// Of the whole surface first, and then of each part of it. Half of what is
// confirmed counts as rough still: it is known but to a factor, and were the
// weight that of what is left alone, what is wrong with the mesh in other ways
// would weigh more than the images.
void LevelRefiner::EstimateWeights() {
  // As often a pixel's noise is counted, in the windows of both directions and
  // of several pairs, as an energy of independent pixels would have it; found
  // by trial on rendered scenes.
  constexpr double kRedundancy = 8;
  constexpr double kMaxChange = 4;
  const ThinPlate& plate = surface_.plate;
  const NormalEquations equations(surface_.mesh, surface_.normals, rings_,
                                  surface_.terms, plate);
  SmoothnessEvidence evidence;
  evidence.determined = equations.Determined(kTolerance, kMaxIterations);
  evidence.roughness.resize(weights_.size());
  const double factor = options_.smoothness_weight * kRedundancy;
  for (size_t i = 0; i < weights_.size(); ++i) {
    evidence.determined[i] *= factor;
    const double of_rest = plate.residuals[i];
    const double of_none = of_rest + (is_seen_[i] != 0 ? rest_[i] : 0);
    evidence.roughness[i] = plate.coefficients[i] / weights_[i] *
                            (of_rest * of_rest + of_none * of_none) / 2;
  }
  weight_ = std::clamp(GlobalWeight(evidence), weight_ / kMaxChange,
                       weight_ * kMaxChange);
  weights_ = LocalWeights(rings_, std::move(evidence), weight_);
  surface_.plate = PlateOf(surface_);
}

// [V] along the normals, scene units.
std::vector<double> LevelRefiner::SolveForMotion() const {
  const NormalEquations equations(surface_.mesh, surface_.normals, rings_,
                                  surface_.terms, surface_.plate);
  if (options_.solver == RefinementSolver::kGaussNewton) {
    return equations.Solve(kTolerance, kMaxIterations);
  }
  std::vector<double> motion(surface_.mesh.vertices.size(), 0);
  for (size_t i = 0; i < motion.size(); ++i) {
    if (equations.Diagonal()[i] > 0) {
      motion[i] = -equations.Gradient()[i] / equations.Diagonal()[i];
    }
  }
  return motion;
}

void LevelRefiner::LimitMotion(std::vector<double>* motion) const {
  constexpr double kMaxEdgeShare = 0.4;  // of the edges' mean length
  const std::vector<Eigen::Vector3f>& vertices = surface_.mesh.vertices;
  tbb::parallel_for(size_t{0}, motion->size(), [&](size_t i) {
    const auto ring = rings_.neighbors[i];
    double length = 0;
    for (const uint32_t neighbor : ring) {
      length += (vertices[neighbor] - vertices[i]).norm();
    }
    length *=
        kMaxEdgeShare / std::max<double>(1, static_cast<double>(ring.size()));
    const double limit = std::min<double>(length, footprints_[i]);
    (*motion)[i] = std::clamp((*motion)[i], -limit, limit);
  });
}

// Vertices of facets that would turn by more than 60 degrees go half as far,
// or, after four times, not at all.
TriangleMesh LevelRefiner::Move(std::vector<double>* motion) {
  constexpr float kMinCosine = 0.5F;
  constexpr int kMaxHalvings = 4;
  const TriangleMesh& mesh = surface_.mesh;
  const std::vector<Eigen::Vector3f> before = FacetNormals(mesh);
  TriangleMesh moved = mesh;
  std::vector<uint8_t> is_shortened(mesh.vertices.size(), 0);
  for (int halving = 0;; ++halving) {
    tbb::parallel_for(size_t{0}, mesh.vertices.size(), [&](size_t i) {
      moved.vertices[i] = mesh.vertices[i] + static_cast<float>((*motion)[i]) *
                                                 surface_.normals[i];
    });
    const std::vector<Eigen::Vector3f> after = FacetNormals(moved);
    std::vector<uint8_t> is_turned(mesh.vertices.size(), 0);
    for (size_t i = 0; i < mesh.facets.size(); ++i) {
      if (before[i].dot(after[i]) < kMinCosine * before[i].squaredNorm()) {
        for (const uint32_t vertex : mesh.facets[i]) {
          is_turned[vertex] = (*motion)[vertex] != 0;
        }
      }
    }
    if (std::find(is_turned.begin(), is_turned.end(), 1) == is_turned.end()) {
      break;
    }
    for (size_t i = 0; i < is_turned.size(); ++i) {
      if (is_turned[i] != 0) {
        (*motion)[i] *= halving < kMaxHalvings ? 0.5 : 0.0;
        is_shortened[i] = 1;
      }
    }
  }
  num_shortened_steps_ +=
      std::count(is_shortened.begin(), is_shortened.end(), 1);
  return moved;
}

// One iteration. Returns the mean motion, px; 0 if the energy can not be made
// to fall.
double LevelRefiner::Step() {
  constexpr int kMaxTrials = 3;
  std::vector<double> motion = SolveForMotion();
  LimitMotion(&motion);
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    const TriangleMesh moved = Move(&motion);
    Surface next = WithPlate(moved, energy_->Evaluate(moved, LabelsInUse()));
    if (next.Energy() < surface_.Energy()) {
      surface_ = std::move(next);
      double sum = 0;
      for (size_t i = 0; i < motion.size(); ++i) {
        sum += std::abs(motion[i]) / footprints_[i];
      }
      return sum / static_cast<double>(motion.size());
    }
    for (double& distance : motion) {
      distance /= 2;
    }
  }
  return 0;
}

bool LevelRefiner::Report(double step, const OnLevelStep& on_step,
                          TriangleMesh* mesh) const {
  mesh->vertices = surface_.mesh.vertices;
  RefinementStep report;
  report.level = level_;
  report.is_final = is_final_;
  report.iteration = iteration_;
  report.energy = surface_.Energy();
  report.photometric_energy = surface_.terms.energy;
  double weight = 0;
  for (const float facet_weight : surface_.terms.weights) {
    weight += facet_weight;
  }
  const double saturation = 1 + options_.photometric.residual_floor;
  report.mean_zncc =
      weight > 0 ? -saturation *
                       std::expm1(surface_.terms.energy / weight / saturation)
                 : 0;
  report.mean_step = step;
  report.num_vertices = mesh->vertices.size();
  report.num_facets = mesh->facets.size();
  return on_step(report);
}

}  // namespace

size_t RefineLevel(const FacetwiseRefinementOptions& options, int level,
                   const FacetLabels& labels, const std::vector<View>& views,
                   const std::vector<Eigen::Vector3f>& origins,
                   PhotometricEnergy* energy, TriangleMesh* mesh,
                   const OnLevelStep& on_step) {
  LevelRefiner refiner(options, level, labels, views, origins, energy, *mesh);
  refiner.Run(on_step, mesh);
  return refiner.NumShortenedSteps();
}

}  // namespace colmap_ext
