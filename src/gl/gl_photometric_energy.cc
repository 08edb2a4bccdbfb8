#include "gl/gl_photometric_energy.h"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>
#include <vector>

#include "gl/pair_passes.h"
#include "photometry/pair_work.h"

namespace colmap_ext {
namespace {

static_assert(sizeof(FacetTerms) == 12 * sizeof(float));  // as gather.comp
constexpr size_t kVertexBytes = 3 * sizeof(float);
constexpr size_t kNormalBytes = 3 * sizeof(double);

// The size of a mesh and its labels on the card.
struct MeshSize {
  size_t num_vertices = 0;
  size_t num_facets = 0;
  size_t num_compared = 0;  // facets, over all directions

  // Of the buffers, bytes.
  size_t Memory() const {
    constexpr size_t kFacetBytes = sizeof(Facet) + kNormalBytes +
                                   sizeof(FacetTerms) +
                                   sizeof(uint32_t);  // the last: its stamp
    return 2 * kVertexBytes * num_vertices + kFacetBytes * num_facets +
           sizeof(uint32_t) * num_compared;
  }

  // Of the largest of those that shaders need as a whole, bytes.
  size_t LargestBlock() const {
    return std::max(kNormalBytes * num_facets, kVertexBytes * num_vertices);
  }
};

std::string Megabytes(size_t num_bytes) {
  return std::to_string((num_bytes + 999'999) / 1'000'000) + " MB";
}

// All that needs the context to be current.
class Evaluator {
 public:
  // \param max_memory  of views, where the limits have none.
  Evaluator(const PhotometricOptions& options,
            std::shared_ptr<ImagePyramid> images, const GlLimits& limits,
            size_t max_memory)
      : images_(std::move(images)),
        limits_(limits),
        views_(images_, options.min_cosine, max_memory),
        facet_normals_({"facet_normals.comp"}),
        passes_(options, limits) {}

  // Why a mesh does not fit on the card at the images' level; empty if it does.
  std::string Lack(const MeshSize& size) const {
    if (size.LargestBlock() > limits_.max_block) {
      return std::to_string(size.num_facets) + " facets take " +
             Megabytes(size.LargestBlock()) + " in one piece, of " +
             Megabytes(limits_.max_block);
    }
    const size_t needed = size.Memory() + MinMemory(size.num_facets);
    if (needed > limits_.max_memory) {
      return std::to_string(size.num_facets) + " facets and two images take " +
             Megabytes(needed) + ", of " + Megabytes(limits_.max_memory);
    }
    return "";
  }

  // Cameras, or the images' level, have changed.
  void DropViews() { views_.Clear(); }

  void Render(std::shared_ptr<const TriangleMesh> mesh) {
    MakeRoom({mesh->vertices.size(), mesh->facets.size(), 0});
    views_.SetMesh(std::move(mesh));
  }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) {
    const size_t num_facets = mesh.facets.size();
    const Rows<uint32_t> facets = GroupByDirection(labels);
    MakeRoom({mesh.vertices.size(), num_facets, facets.values.size()});
    vertices_.Assign(mesh.vertices);
    chosen_facets_.Assign(facets.values);
    ComputeNormals(num_facets);
    sums_.Resize(num_facets * sizeof(FacetTerms));
    sums_.SetZero();
    for (size_t i = 0; i < facets.size(); ++i) {
      const auto [first, second] = labels.pairs[i / 2];
      if (!facets[i].empty()) {
        AddDirection(i % 2 == 0 ? first : second, i % 2 == 0 ? second : first,
                     facets.offsets[i], facets[i]);
      }
    }
    PhotometricTerms terms{0, sums_.Read<FacetTerms>(num_facets)};
    for (const FacetTerms& facet : terms.facets) {
      terms.energy += facet.energy;
    }
    return terms;
  }

 private:
  // Beside the mesh, at least, bytes: the passes, and the views of a pair.
  size_t MinMemory(size_t num_facets) const {
    size_t of_view = 0;
    for (const View& view : images_->Views()) {
      of_view = std::max(of_view, ViewTextures::Memory(view, num_facets));
    }
    return PairPasses::Memory(images_->Views()) + 2 * of_view;
  }

  // Views get what the mesh leaves.
  void MakeRoom(const MeshSize& size) {
    if (const std::string lack = Lack(size); !lack.empty()) {
      throw GlError(lack);
    }
    if (limits_.max_memory != SIZE_MAX) {
      views_.SetMaxMemory(limits_.max_memory - size.Memory() -
                          PairPasses::Memory(images_->Views()));
    }
  }

  void ComputeNormals(size_t num_facets) {
    normals_.Resize(num_facets * kNormalBytes);
    vertices_.BindToStorage(0);
    views_.Facets().BindToStorage(1);
    normals_.BindToStorage(2);
    facet_normals_.Set("num_facets", static_cast<unsigned int>(num_facets));
    Dispatch(facet_normals_, num_facets);
  }

  // \param i  the view where view j is compared
  // \param first  of the facets, in chosen_facets_
  void AddDirection(uint32_t i, uint32_t j, uint64_t first,
                    std::span<const uint32_t> facets) {
    const std::shared_ptr<const ViewTextures> textures_i = views_.Get(i);
    const std::shared_ptr<const ViewTextures> textures_j = views_.Get(j);
    const std::vector<View>& views = images_->Views();
    passes_.Run({views[i], views[j], *textures_i, *textures_j, first, facets},
                {views_.Vertices(), vertices_, views_.Facets(), chosen_facets_,
                 normals_, sums_});
  }

  std::shared_ptr<ImagePyramid> images_;
  GlLimits limits_;
  ViewTextureCache views_;
  Program facet_normals_;
  PairPasses passes_;
  GlBuffer vertices_;       // the present ones
  GlBuffer chosen_facets_;  // see GroupByDirection()
  GlBuffer normals_;        // [F][3] double
  GlBuffer sums_;           // [F] FacetTerms
};

// The processor draws the visibility buffers that callers request, and takes
// over where the card fails.
class GlPhotometricEnergy : public PhotometricEnergy {
 public:
  GlPhotometricEnergy(const PhotometricOptions& options,
                      std::shared_ptr<ImagePyramid> images, GlOptions gl)
      : warn_(std::move(gl.warn)),
        context_(gl.gpu_index),
        cpu_(MakeCpuPhotometricEnergy(options, images, gl.max_memory)) {
    const EglContext::Scope scope = context_.MakeCurrent();
    auto evaluator = std::make_unique<Evaluator>(
        options, std::move(images),
        FindGlLimits(gl.limits, context_.IsSoftware()), gl.max_memory);
    ThrowOnGlError("The photometric energy");
    // A closed mesh has half as many vertices.
    const std::string lack =
        evaluator->Lack({gl.expected_facets / 2, gl.expected_facets,
                         gl.expected_facets * gl.expected_directions});
    if (gl.expected_facets > 0 && !lack.empty()) {
      Warn("the finest level may not fit on the graphics card (about " + lack +
           "); the processor computes what does not fit");
    }
    evaluator_ = std::move(evaluator);
  }

  ~GlPhotometricEnergy() override { DropEvaluator(); }

  void SetLevel(int level) override {
    cpu_->SetLevel(level);
    TryGl([](Evaluator* evaluator) { evaluator->DropViews(); });
  }

  void SetViews(std::vector<View> views) override {
    cpu_->SetViews(std::move(views));
    TryGl([](Evaluator* evaluator) { evaluator->DropViews(); });
  }

  std::shared_ptr<const VisibilityBuffers> Visibility(
      const TriangleMesh& mesh) override {
    return cpu_->Visibility(mesh);
  }

  void Render(const TriangleMesh& mesh) override {
    drawn_ = std::make_shared<const TriangleMesh>(mesh);
    if (!TryGl([&](Evaluator* evaluator) { evaluator->Render(drawn_); })) {
      drawn_.reset();
      cpu_->Render(mesh);
    }
  }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override {
    assert(labels.NumFacets() == mesh.facets.size());
    PhotometricTerms terms;
    if (TryGl([&](Evaluator* evaluator) {
          terms = evaluator->Evaluate(mesh, labels);
        })) {
      return terms;
    }
    if (const auto drawn = std::exchange(drawn_, nullptr)) {
      cpu_->Render(*drawn);
    }
    return cpu_->Evaluate(mesh, labels);
  }

  std::string Description() const override {
    return evaluator_ ? "OpenGL, " + context_.RendererName() +
                            (context_.IsSoftware() ? " (software)" : "")
                      : cpu_->Description();
  }

 private:
  // Runs a function on the card, unless the card has failed before.
  // \return whether it succeeded
  template <typename Function>
  bool TryGl(const Function& function) {
    if (!evaluator_) {
      return false;
    }
    try {
      const EglContext::Scope scope = context_.MakeCurrent();
      function(evaluator_.get());
      ThrowOnGlError("The photometric energy");
      return true;
    } catch (const GlError& error) {
      DropEvaluator();
      Warn(std::string("the graphics card gave up (") + error.what() +
           "); the processor computes the rest");
      return false;
    }
  }

  void DropEvaluator() {
    if (!evaluator_) {
      return;
    }
    try {
      const EglContext::Scope scope = context_.MakeCurrent();
      evaluator_.reset();
      return;
    } catch (const GlError&) {
      // The context is lost, and the evaluator's objects with it.
    }
    try {
      // Here their names are unknown: deleting them does nothing.
      const EglContext context;
      const EglContext::Scope scope = context.MakeCurrent();
      evaluator_.reset();
    } catch (const GlError&) {
      static_cast<void>(evaluator_.release());
    }
  }

  void Warn(const std::string& warning) const {
    if (warn_) {
      warn_(warning);
    }
  }

  std::function<void(const std::string& warning)> warn_;
  EglContext context_;
  std::unique_ptr<PhotometricEnergy> cpu_;
  std::unique_ptr<Evaluator> evaluator_;       // none: the card has failed
  std::shared_ptr<const TriangleMesh> drawn_;  // on the card; none: not there
};

}  // namespace

std::unique_ptr<PhotometricEnergy> MakeGlPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    GlOptions gl) {
  return std::make_unique<GlPhotometricEnergy>(options, std::move(images),
                                               std::move(gl));
}

}  // namespace colmap_ext
