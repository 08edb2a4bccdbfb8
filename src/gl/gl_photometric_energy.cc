#include "gl/gl_photometric_energy.h"

#include <array>
#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "gl/debug_output.h"
#include "gl/egl_context.h"
#include "gl/pair_passes.h"
#include "gl/view_textures.h"
#include "photometry/pair_work.h"

namespace colmap_ext {

namespace {

// What all pairs say about a facet, as gather.comp writes it.
struct FacetSums {
  float energy;
  float weight;
  float num_pixels;
  std::array<float, 3> slopes;
  std::array<float, 6> curvatures;
};
static_assert(sizeof(FacetSums) == 12 * sizeof(float));

PhotometricTerms Terms(const std::vector<FacetSums>& sums) {
  PhotometricTerms terms;
  terms.energies.resize(sums.size());
  terms.weights.resize(sums.size());
  terms.num_pixels.resize(sums.size());
  terms.slopes.resize(sums.size());
  terms.curvatures.resize(sums.size());
  tbb::parallel_for(size_t{0}, sums.size(), [&](size_t i) {
    terms.energies[i] = sums[i].energy;
    terms.weights[i] = sums[i].weight;
    terms.num_pixels[i] = sums[i].num_pixels;
    terms.slopes[i] = sums[i].slopes;
    terms.curvatures[i] = sums[i].curvatures;
  });
  for (const float energy : terms.energies) {
    terms.energy += energy;
  }
  return terms;
}

// All that needs the context to be current.
class Evaluator {
 public:
  Evaluator(const PhotometricOptions& options,
            std::shared_ptr<ImagePyramid> images, size_t max_memory)
      : images_(std::move(images)),
        views_(images_, options.min_cosine, max_memory),
        facet_normals_({"facet_normals.comp"}),
        passes_(options) {}

  void SetLevel(int level) {
    images_->SetLevel(level);
    views_.Clear();
  }

  void SetViews(std::vector<View> views) {
    images_->SetViews(std::move(views));
    views_.Clear();
  }

  void Render(const TriangleMesh& mesh) { views_.SetMesh(mesh); }

  std::vector<FacetSums> Evaluate(const TriangleMesh& mesh,
                                  const FacetLabels& labels) {
    const size_t num_facets = mesh.facets.size();
    const Rows<uint32_t> facets = GroupByDirection(labels);
    vertices_.Assign(mesh.vertices);
    chosen_facets_.Assign(facets.values);
    ComputeNormals(num_facets);
    sums_.Resize(num_facets * sizeof(FacetSums));
    sums_.SetZero();
    for (size_t i = 0; i < facets.size(); ++i) {
      const auto [first, second] = labels.pairs[i / 2];
      const auto begin = static_cast<uint32_t>(facets.offsets[i]);
      const auto end = static_cast<uint32_t>(facets.offsets[i + 1]);
      if (begin != end) {
        AddDirection(i % 2 == 0 ? first : second, i % 2 == 0 ? second : first,
                     begin, end - begin);
      }
    }
    return sums_.Read<FacetSums>(num_facets);
  }

 private:
  void ComputeNormals(size_t num_facets) {
    constexpr size_t kNormalBytes = 3 * sizeof(double);
    normals_.Resize(num_facets * kNormalBytes);
    vertices_.BindToStorage(0);
    views_.Facets().BindToStorage(1);
    normals_.BindToStorage(2);
    facet_normals_.Set("num_facets", static_cast<unsigned int>(num_facets));
    Dispatch(facet_normals_, num_facets);
  }

  // \param i  the view where view j is compared
  void AddDirection(uint32_t i, uint32_t j, uint32_t first_facet,
                    uint32_t num_facets) {
    const std::shared_ptr<const ViewTextures> textures_i = views_.Get(i);
    const std::shared_ptr<const ViewTextures> textures_j = views_.Get(j);
    const std::vector<View>& views = images_->Views();
    passes_.Run(
        {views[i], views[j], *textures_i, *textures_j, first_facet, num_facets},
        {views_.Vertices(), vertices_, views_.Facets(), chosen_facets_,
         normals_, sums_});
  }

  std::shared_ptr<ImagePyramid> images_;
  ViewTextureCache views_;
  Program facet_normals_;
  PairPasses passes_;
  GlBuffer vertices_;       // the present ones
  GlBuffer chosen_facets_;  // see GroupByDirection()
  GlBuffer normals_;        // [F][3] double
  GlBuffer sums_;           // [F] FacetSums
};

class GlPhotometricEnergy : public PhotometricEnergy {
 public:
  GlPhotometricEnergy(const PhotometricOptions& options,
                      std::shared_ptr<ImagePyramid> images, int gpu_index,
                      size_t max_memory)
      : min_cosine_(options.min_cosine), images_(images), context_(gpu_index) {
    const EglContext::Scope scope = context_.MakeCurrent();
    evaluator_.emplace(options, std::move(images), max_memory);
    ThrowOnGlError("The photometric energy");
  }

  ~GlPhotometricEnergy() override {
    const EglContext::Scope scope = context_.MakeCurrent();
    evaluator_.reset();
  }

  void SetLevel(int level) override {
    const EglContext::Scope scope = context_.MakeCurrent();
    evaluator_->SetLevel(level);
  }

  void SetViews(std::vector<View> views) override {
    const EglContext::Scope scope = context_.MakeCurrent();
    evaluator_->SetViews(std::move(views));
  }

  // Not for Render(), which draws on the graphics card. None is kept.
  std::shared_ptr<const MeshDrawings> Drawings(
      const TriangleMesh& mesh) override {
    return std::make_shared<const MeshDrawings>(
        mesh, images_->Views(), min_cosine_, 0,
        [images = images_](size_t view) { return images->Mask(view); });
  }

  void Render(const TriangleMesh& mesh) override {
    const EglContext::Scope scope = context_.MakeCurrent();
    evaluator_->Render(mesh);
    ThrowOnGlError("Drawing the mesh");
  }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override {
    assert(labels.NumFacets() == mesh.facets.size());
    const EglContext::Scope scope = context_.MakeCurrent();
    const std::vector<FacetSums> sums = evaluator_->Evaluate(mesh, labels);
    ThrowOnGlError("The photometric energy");
    return Terms(sums);
  }

  std::string Description() const override {
    return "OpenGL, " + context_.RendererName() +
           (context_.IsSoftware() ? " (software)" : "");
  }

 private:
  double min_cosine_;
  std::shared_ptr<ImagePyramid> images_;
  EglContext context_;
  std::optional<Evaluator> evaluator_;
};

}  // namespace

std::unique_ptr<PhotometricEnergy> MakeGlPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    int gpu_index, size_t max_memory) {
  return std::make_unique<GlPhotometricEnergy>(options, std::move(images),
                                               gpu_index, max_memory);
}

}  // namespace colmap_ext
