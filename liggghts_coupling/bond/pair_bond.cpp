// SPDX-License-Identifier: GPL-2.0-or-later
/// `pair_style gran model bond/contact|bond/parallel [exponent 1|1.5] [ledger on] [radius R]`: the
/// bond law as a LIGGGHTS granular model. Its history, its way over ranks and into restart files
/// are LIGGGHTS' own.
#include "liggghts_coupling/bond/pair_bond.h"

// The order of these matters: fix_insert_stream.h before pair_gran_base.h.
// clang-format off
#include <mpi.h>
#include <lammps.h>
#include <atom.h>
#include <domain.h>
#include <error.h>
#include <force.h>
#include <modify.h>
#include <neighbor.h>
#include <update.h>
#include <contact_models.h>
#include <fix_insert_stream.h>
#include <global_properties.h>
#include <pair_gran_base.h>
// clang-format on

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "liggghts_coupling/bond/bond_book.h"

namespace LIGGGHTS::ContactModels {
namespace {

using dem::BondBook;
using LAMMPS_NS::LAMMPS;

/// What `pair_style gran model` calls the two kinds of bonds; 6-bit ids, the library uses 0 … 9.
struct ContactBond {
  static constexpr int id = 60;
  static constexpr const char* name = "bond/contact";
  static constexpr bool moments = false;
};
struct ParallelBond {
  static constexpr int id = 61;
  static constexpr const char* name = "bond/parallel";
  static constexpr bool moments = true;
};
constexpr double kLargestFactor = 1.5;  // reach of a pair's history over the sum of radii

/// A property per pair of types, by its name in the script.
template <const char* const& name>
MatrixProperty* property(PropertyRegistry& registry, const char* caller, bool sanity_checks) {
  return MODEL_PARAMS::createPerTypePairProperty(registry, name, caller, sanity_checks, 0.0);
}
constexpr const char* kContactNormal = "contactNormalStiffness";
constexpr const char* kContactShear = "contactShearStiffness";
constexpr const char* kFriction = "coefficientFriction";
constexpr const char* kDamping = "contactDampingRatio";
constexpr const char* kBondNormal = "bondNormalStiffness";
constexpr const char* kBondShear = "bondShearStiffness";
constexpr const char* kTensile = "bondTensileStrength";
constexpr const char* kShear = "bondShearStrength";

template <class Kind>
class BondModel : protected Pointers {
 public:
  BondModel(LAMMPS* lammps, IContactHistorySetup* history, bool is_wall, const int64_t)
      : Pointers(lammps) {
    if (is_wall)
      fail(std::string(Kind::name) + " is no wall model; use fix wall/gran model hooke/stiffness");
    bonded_ = history->add_history_value("bonded", "0");
    book_->column = bonded_;
    history->add_history_value("bondRestOverlap", "0");
    // "1": seen from the other particle, with the other sign
    for (const char* name : {"shearForceX", "shearForceY", "shearForceZ"})
      history->add_history_value(name, "1");
    if constexpr (Kind::moments)
      for (const char* name : {"momentX", "momentY", "momentZ"})
        history->add_history_value(name, "1");
  }

  int64_t hashcode() { return Kind::id; }
  void registerSettings(Settings& settings) {
    settings.registerDoubleSetting("exponent", exponent_, 1.0);
    settings.registerOnOff("ledger", ledger_, false);
    if constexpr (Kind::moments) settings.registerDoubleSetting("radius", radius_, 1.0);
  }
  void postSettings(IContactHistorySetup*) {
    if (exponent_ != 1.0 && exponent_ != 1.5)
      fail(std::string("pair_style gran model ") + Kind::name +
           ": exponent is 1 (linear) or 1.5 (Hertz)");
    if (radius_ <= 0.0 || radius_ > 1.0)
      fail(
          "pair_style gran model bond/parallel: radius, of the bond over the smaller particle, is "
          "above 0 and at most 1");
  }
  void connectToProperties(PropertyRegistry& registry) {
    connect<kContactNormal>(registry, contact_normal_);
    connect<kContactShear>(registry, contact_shear_);
    connect<kFriction>(registry, friction_);
    connect<kDamping>(registry, damping_);
    connect<kBondNormal>(registry, bond_normal_);
    connect<kBondShear>(registry, bond_shear_);
    connect<kTensile>(registry, tensile_);
    connect<kShear>(registry, shear_);
    check_settings();
    reserve_range(registry);
  }
  int get_history_offset(const std::string&) { return -1; }
  bool contact_match(const std::string& type, const std::string& model) {
    return type == "normal" && model == Kind::name;
  }
  double stressStrainExponent() { return exponent_; }
  bool checkSurfaceIntersect(SurfacesIntersectData&) { return true; }
  void endSurfacesIntersect(SurfacesIntersectData&, LAMMPS_NS::TriMesh*, ForceData&, ForceData&) {}

  void beginPass(SurfacesIntersectData& data, ForceData&, ForceData&) {
    wishes_ = data.computeflag && std::ranges::any_of(book_->requests, &dem::BondRequest::open);
    if (!data.computeflag) return;
    book_->intact = 0;
    book_->energy.elastic = 0.0;
    book_->listed.clear();
  }
  void endPass(SurfacesIntersectData& data, ForceData&, ForceData&) {
    if (!data.computeflag) return;
    for (dem::BondRequest& request : book_->requests) request.open = false;
  }

  void surfacesIntersect(SurfacesIntersectData& data, ForceData& on_i, ForceData& on_j) {
    act(data, on_i, on_j);
  }
  /// Surfaces that do not touch: only a bond acts. LIGGGHTS passes the larger structure here too,
  /// but leaves what it holds beyond the smaller one unset.
  void surfacesClose(SurfacesCloseData& close, ForceData& on_i, ForceData& on_j) {
    auto& data = static_cast<SurfacesIntersectData&>(close);
    if (!close.contact_history) return;
    if (close.contact_history[bonded_] == 0.0 && !(wishes_ && wanted(data, -1.0))) {
      forget(data);
      return;
    }
    data.r = std::sqrt(close.rsq);
    data.rinv = 1.0 / data.r;
    for (int k = 0; k < 3; ++k) data.en[k] = close.delta[k] * data.rinv;
    data.omega_i = atom->omega[close.i];
    data.omega_j = atom->omega[close.j];
    const double mi = atom->rmass[close.i], mj = atom->rmass[close.j];
    data.meff = mi * mj / (mi + mj);
    act(data, on_i, on_j);
  }

 private:
  template <const char* const& name>
  void connect(PropertyRegistry& registry, double**& values) {
    registry.registerProperty(name, &property<name>);
    registry.connect(name, values, Kind::name);
  }

  void fail(const std::string& text) { error->all(FLERR, text.c_str()); }

  void check_settings() {
    if (atom->map_style == 0) fail(std::string(Kind::name) + " needs 'atom_modify map array'");
  }

  /// Bonds may stretch across a gap: the range in which a pair keeps its history must cover it,
  /// or LIGGGHTS would drop the bond without a word.
  void reserve_range(PropertyRegistry& registry) {
    double gap = book_->largest_gap;
    for (const dem::BondRequest& request : book_->requests) gap = std::max(gap, request.gap);
    double stretch = 0.0;
    int worst[2] = {1, 1};
    for (int a = 1; a <= atom->ntypes; ++a)
      for (int b = 1; b <= atom->ntypes; ++b) {
        if (bond_normal_[a][b] <= 0.0) continue;
        const double here = tensile_[a][b] * (1.0 + book_->spread) / bond_normal_[a][b];
        if (here <= stretch) continue;
        stretch = here;
        worst[0] = a;
        worst[1] = b;
      }
    const double smallest = 2.0 * registry.min_radius(), reach = stretch + gap;
    const double factor = 1.0 + 1.05 * reach / smallest;
    if (factor > kLargestFactor)
      fail(fmt::format(
          "a bond of types {} and {} stretches by bondTensileStrength/bondNormalStiffness = {:.4g} "
          "m "
          "before it breaks, with a first gap of {:.4g} m; {:.4g} m is the most for the smallest "
          "diameter, {:.4g} m. Raise bondNormalStiffness or lower bondTensileStrength",
          worst[0], worst[1], stretch, gap, (kLargestFactor - 1.0) / 1.05 * smallest, smallest));
    neighbor->register_contact_dist_factor(std::max(factor, 1.01));
    book_->reserved_gap = (std::max(factor, 1.01) - 1.0) * smallest - stretch;
    const double meet = 2.0 * registry.max_radius() * factor + neighbor->skin;
    for (int k = 0; k < domain->dimension; ++k)
      if (domain->periodicity[k] && domain->prd[k] < 2.0 * meet)
        fail(fmt::format(
            "the box is {:.4g} m long in its periodic direction {}; two particles can meet there "
            "through both sides, and their bond would be ambiguous. It takes at least {:.4g} m",
            domain->prd[k], "xyz"[k], 2.0 * meet));
  }

  /// Calls `each` with the wishes of which one asks for a bond between the two.
  /// @param overlap  only its sign, in a gap, matters
  template <class Each>
  bool for_wishes(const SurfacesIntersectData& d, double overlap, Each&& each) const {
    bool any = false;
    if (!d.computeflag) return any;
    for (dem::BondRequest& request : book_->requests) {
      if (!request.open) continue;
      const double exact = overlap < 0.0 ? d.radsum - std::sqrt(d.rsq) : overlap;
      if (!request.wants({.ids = {atom->tag[d.i], atom->tag[d.j]},
                          .types = {d.itype, d.jtype},
                          .centres = {atom->x[d.i], atom->x[d.j]},
                          .overlap = exact}))
        continue;
      each(request);
      any = true;
    }
    return any;
  }
  bool wanted(const SurfacesIntersectData& d, double overlap) const {
    return for_wishes(d, overlap, [](const dem::BondRequest&) {});
  }

  /// Bonds a pair that some fix bond/create asks for. @param counted  by this process
  void bond_where_wanted(dem::PairMemory& memory, const SurfacesIntersectData& d,
                         const dem::ContactLaw& contact, const dem::BondLaw& bond, double overlap,
                         bool counted) {
    for_wishes(d, overlap, [&](dem::BondRequest& request) {
      request.found += counted;
      if (memory.bonded) return;
      dem::make_bond(memory, contact, bond, overlap);
      book_->largest_gap = std::max({book_->largest_gap, -overlap, -memory.rest_overlap});
      request.made += counted;
      book_->tally.created += counted;
    });
  }

  void forget(SurfacesIntersectData& d) {
    if (d.contact_flags) *d.contact_flags = 0;
    std::fill_n(d.contact_history + bonded_, Kind::moments ? 8 : 5, 0.0);
  }

  dem::PairMemory remembered(const SurfacesIntersectData& d) const {
    const double* h = d.contact_history + bonded_;
    dem::PairMemory memory{h[0] != 0.0, h[1], {h[2], h[3], h[4]}, {}};
    if constexpr (Kind::moments) memory.moment = {h[5], h[6], h[7]};
    return memory;
  }
  void remember(SurfacesIntersectData& d, const dem::PairMemory& m) {
    double* h = d.contact_history + bonded_;
    h[0] = m.bonded ? 1.0 : 0.0;
    h[1] = m.rest_overlap;
    for (int k = 0; k < 3; ++k) {
      h[2 + k] = m.shear_force[k];
      if constexpr (Kind::moments) h[5 + k] = m.moment[k];
    }
  }

  dem::ContactLaw contact_law(int a, int b) const {
    return {contact_normal_[a][b], exponent_, contact_shear_[a][b], friction_[a][b],
            damping_[a][b]};
  }
  dem::BondLaw bond_law(const SurfacesIntersectData& d) const {
    double factor = 1.0;
    if (book_->spread != 0.0)
      factor = dem::strength_factor(atom->tag[d.i], atom->tag[d.j], book_->spread, book_->seed);
    const int a = d.itype, b = d.jtype;
    dem::BondLaw law{
        bond_normal_[a][b], bond_shear_[a][b], factor * tensile_[a][b], factor * shear_[a][b], {}};
    if constexpr (Kind::moments)
      law.section =
          dem::BondSection::of(radius_ * std::min(d.radi, d.radj), domain->dimension == 3);
    return law;
  }

  /// Arms from the centres to the contact point, which divides the overlap in halves.
  struct Arms {
    double i, j;
  };

  dem::PairMotion motion(const SurfacesIntersectData& d, const Arms& arms) const {
    dem::PairMotion m;
    m.overlap = d.radsum - d.r;
    m.effective_mass = d.meff;
    m.step = update->dt;
    double relative[3], spin[3];
    for (int k = 0; k < 3; ++k) {
      m.normal[k] = d.en[k];
      relative[k] = d.v_i[k] - d.v_j[k];
      spin[k] = arms.i * d.omega_i[k] + arms.j * d.omega_j[k];
      if constexpr (Kind::moments) m.turning[k] = d.omega_i[k] - d.omega_j[k];
      m.normal_velocity += relative[k] * d.en[k];
    }
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, n = (k + 2) % 3;
      m.tangential_velocity[k] =
          relative[k] - m.normal_velocity * d.en[k] - (spin[l] * d.en[n] - spin[n] * d.en[l]);
    }
    return m;
  }

  void act(SurfacesIntersectData& d, ForceData& on_i, ForceData& on_j) {
    const double overlap = d.radsum - d.r;
    const Arms arms{d.radi - 0.5 * overlap, d.radj - 0.5 * overlap};
    const dem::ContactLaw contact = contact_law(d.itype, d.jtype);
    const bool bonded = d.contact_history[bonded_] != 0.0;  // else nothing reads the bond's law
    const dem::BondLaw bond = bonded || wishes_ ? bond_law(d) : dem::BondLaw{};
    dem::PairMemory memory = remembered(d);
    const bool counted = d.computeflag && (d.j < atom->nlocal || atom->tag[d.i] < atom->tag[d.j]);
    if (wishes_) bond_where_wanted(memory, d, contact, bond, overlap, counted);
    const dem::PairMotion m = motion(d, arms);
    const bool advance = d.computeflag && d.shearupdate;
    const dem::PairResponse r = dem::respond(memory, contact, bond, m, advance);
    if (d.computeflag) remember(d, memory);
    if (counted) book(d, m, r, memory.bonded, arms.i, advance);
    d.has_force_update = true;
    if (!r.force) {
      if (d.computeflag && advance) forget(d);
      return;
    }
    if (d.contact_flags) *d.contact_flags |= CONTACT_NORMAL_MODEL;
    d.Fn = r.normal;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, n = (k + 2) % 3;
      const double total = r.normal * d.en[k] + r.tangential[k];
      const double turn = d.en[l] * r.tangential[n] - d.en[n] * r.tangential[l];
      on_i.delta_F[k] += total;
      on_j.delta_F[k] -= total;
      on_i.delta_torque[k] += r.moment[k] - arms.i * turn;
      on_j.delta_torque[k] -= r.moment[k] + arms.j * turn;
    }
  }

  void book(const SurfacesIntersectData& d, const dem::PairMotion& m, const dem::PairResponse& r,
            bool bonded, double arm, bool advance) {
    if (bonded) {
      ++book_->intact;
      if (book_->list_wanted) book_->listed.emplace_back(atom->tag[d.i], atom->tag[d.j]);
    }
    if (ledger_) {
      book_->energy.elastic += r.energy.elastic;
      if (advance) {
        book_->energy.friction += r.energy.friction;
        book_->energy.damping += r.energy.damping;
        book_->energy.released += r.energy.released;
        book_->energy.stiffness_change += r.energy.stiffness_change;
      }
    }
    if (r.broken == dem::Break::None || !advance) return;
    ++(r.broken == dem::Break::Tension ? book_->tally.tension : book_->tally.shear);
    const long a = atom->tag[d.i], b = atom->tag[d.j];
    dem::BreakEvent event{static_cast<long>(update->ntimestep),
                          static_cast<double>(update->ntimestep - book_->first_step) * update->dt,
                          std::min(a, b),
                          std::max(a, b),
                          r.broken,
                          r.break_force,
                          {},
                          m.normal};
    for (int k = 0; k < 3; ++k) {
      event.place[k] = atom->x[d.i][k] - arm * m.normal[k];
      if (a > b) event.normal[k] = -event.normal[k];
    }
    book_->events.push_back(event);
    book_->broken.push_back(event);
  }

  std::shared_ptr<BondBook> book_ = BondBook::of(lmp);
  int bonded_ = 0;  // first of the values of a pair's history: PairMemory
  double exponent_ = 1.0;
  bool ledger_ = false;
  bool wishes_ = false;  // some fix bond/create asks for bonds in this pass
  double radius_ = 1.0;  // of the section over the smaller particle's
  double **contact_normal_ = nullptr, **contact_shear_ = nullptr, **friction_ = nullptr,
         **damping_ = nullptr, **bond_normal_ = nullptr, **bond_shear_ = nullptr,
         **tensile_ = nullptr, **shear_ = nullptr;  // [type][type], from 1
};

template <class Kind>
PairStyles::IGranularPairStyle* create(LAMMPS* lammps, LAMMPS_NS::PairGran* parent, int64_t hash) {
  return new PairStyles::Granular<BondModel<Kind>>(lammps, parent, hash);
}

}  // namespace

template <class Kind>
static void add_model() {
  Factory::instance().addNormalModel(Kind::name, Kind::id);
  PairStyles::Factory::instance().addStyle("gran", Kind::id, &create<Kind>);
}

}  // namespace LIGGGHTS::ContactModels

namespace dem {

void register_bonds() {
  LIGGGHTS::ContactModels::add_model<LIGGGHTS::ContactModels::ContactBond>();
  LIGGGHTS::ContactModels::add_model<LIGGGHTS::ContactModels::ParallelBond>();
}

}  // namespace dem
