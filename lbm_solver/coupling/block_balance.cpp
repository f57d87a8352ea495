// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/block_balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lbm_solver/solver/work.h"

namespace lbm {
namespace {

constexpr std::int64_t kLookSteps = 20;  // between two looks: they cost a hundredth of this
constexpr double kGain = 1.05;           // of the work of the busiest, below which cuts stay

}  // namespace

BlockBalance::BlockBalance(const Scene& scene, const Plan& plan, const Decomposition& ranks)
    : on_(scene.numerics.equal_work && !ranks.alone() && scene.numerics.waiting_bound < 1.0),
      bound_(scene.numerics.waiting_bound),
      every_(std::max<std::int64_t>(1, kLookSteps / plan.fluid_steps)) {}

std::optional<Decomposition> BlockBalance::look(double worked, const Fluid& fluid) {
  const Decomposition& ranks = fluid.ranks();
  const double mine = worked - worked_before_;
  std::array<double, 1> sum{mine};
  worked_before_ = worked;
  ranks.sum(sum);
  const double most = ranks.max(mine), lost = most - sum[0] / ranks.size();
  lost_ += lost;
  waiting_ = most > 0.0 ? lost / most : 0.0;
  const bool always = bound_ == 0.0;  // then the layers alone decide: runs can be repeated
  if (!always && (waiting_ < bound_ || lost_ < cost_)) return {};
  lost_ = 0.0;
  const LayerWork work = work_of(fluid);
  const Decomposition next = of_equal_work(ranks, work);
  before_ = imbalance(ranks, work);
  after_ = imbalance(next, work);
  if (before_ <= after_ * (always ? 1.0 : kGain)) return {};
  return next;
}

std::string BlockBalance::moved(double seconds, const Decomposition& ranks) {
  ++moves_;
  cost_ = ranks.max(seconds);
  return fmt::format(
      "the blocks are cut anew{}: about {:.2f} of the mean work for the busiest, {:.2f} before; "
      "the others waited {:.0f} % of its time; moved in {:.3g} s",
      cuts_text(ranks), after_, before_, 100.0 * waiting_, cost_);
}

}  // namespace lbm
