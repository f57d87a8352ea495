scene_check.o: lbm_solver/solver/scene_check.cpp \
 /tmp/vis/drv/lbm_solver/solver/scene_check.h \
 /tmp/vis/drv/lbm_solver/solver/plan.h \
 /tmp/vis/drv/lbm_solver/base/scene.h /tmp/vis/drv/lbm_solver/base/side.h \
 /tmp/vis/drv/lbm_solver/base/units.h /tmp/vis/drv/lbm_solver/base/vec3.h \
 /work/wt-viscosity/protocol/messages.h \
 /tmp/vis/drv/lbm_solver/solver/block_loads.h \
 /tmp/vis/drv/lbm_solver/immersed/body.h \
 /tmp/vis/drv/lbm_solver/solver/fluid.h \
 /tmp/vis/drv/lbm_solver/base/record.h \
 /tmp/vis/drv/lbm_solver/boundary/patch.h \
 /tmp/vis/drv/lbm_solver/boundary/in_time.h \
 /tmp/vis/drv/lbm_solver/field/cell_pass.h \
 /tmp/vis/drv/lbm_solver/field/esoteric_pull.h \
 /tmp/vis/drv/lbm_solver/base/unroll.h \
 /tmp/vis/drv/lbm_solver/field/domain.h \
 /tmp/vis/drv/lbm_solver/field/populations.h \
 /tmp/vis/drv/lbm_solver/lattice/lattice.h \
 /tmp/vis/drv/lbm_solver/field/halo_exchange.h \
 /tmp/vis/drv/lbm_solver/field/decomposition.h \
 /tmp/vis/drv/lbm_solver/immersed/body_scheme.h \
 /tmp/vis/drv/lbm_solver/immersed/footprint.h \
 /tmp/vis/drv/lbm_solver/immersed/cover_block.h \
 /tmp/vis/drv/lbm_solver/base/simd.h \
 /tmp/vis/drv/lbm_solver/immersed/two_step_loads.h \
 /tmp/vis/drv/lbm_solver/solver/kernel.h \
 /tmp/vis/drv/lbm_solver/collision/collision_operator.h \
 /tmp/vis/drv/lbm_solver/collision/parameters.h \
 /tmp/vis/drv/lbm_solver/immersed/cover_map.h \
 /tmp/vis/drv/lbm_solver/immersed/radius_shift.h \
 /tmp/vis/drv/lbm_solver/immersed/weight.h \
 /tmp/vis/drv/lbm_solver/solver/row_moments.h \
 /tmp/vis/drv/lbm_solver/immersed/solid_share.h \
 /tmp/vis/drv/lbm_solver/immersed/resistance.h \
 /tmp/vis/drv/lbm_solver/immersed/solid_term.h \
 /tmp/vis/drv/lbm_solver/collision/equilibrium.h \
 /tmp/vis/drv/lbm_solver/collision/tensors.h \
 /tmp/vis/drv/lbm_solver/collision/forcing.h \
 /tmp/vis/drv/lbm_solver/collision/moments.h \
 /tmp/vis/drv/lbm_solver/base/errors.h \
 /work/wt-viscosity/protocol/errors.h \
 /tmp/vis/drv/lbm_solver/solver/driven_speed.h
