/* SPDX-License-Identifier: MIT */
/* A small solid program in C: soft discs or spheres under gravity, with linear springs and dashpots between them and
 * with the walls of the box. Everything that it needs comes as variables of the fluid's scene; it has no input file.
 *
 *   F_n = k d - g v_n,  g = 2 xi sqrt(m k);  velocity Verlet, in which the load of an interval acts in each of its steps
 *
 * On several ranks each one moves all particles, and speaks for those whose id is its own modulo the number of ranks. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bplbm_solid.h"

typedef struct {
  bplbm_solid* wire;
  bplbm_setup setup;
  int dimension, ranks, rank;
  int walls[3]; /* whether there are walls across x, y, z */
  double stiffness, damping;
  bplbm_shape shape; /* of every particle */
  int64_t n, room;
  bplbm_state* states;
  bplbm_shape* shapes;
  bplbm_load* loads;
  double* accelerations; /* [n][3] */
} Solid;

static double number(Solid* s, const char* name) {
  double value = 0.0;
  bplbm_number(s->wire, name, &value);
  return value;
}
static double number_or(Solid* s, const char* name, double otherwise) {
  return bplbm_variable(s->wire, name) ? number(s, name) : otherwise;
}

/* Reads what belongs to the whole scene. */
static void read_scene(Solid* s) {
  static const char axes[] = "xyz";
  char name[40];
  bplbm_setup* setup = &s->setup;
  bplbm_scene(s->wire, setup);
  s->dimension = setup->dimension;
  const double g = number(s, "gravity");
  for (int k = 0; k < 3; ++k) {
    const char* boundary;
    snprintf(name, sizeof name, "%c_lo", axes[k]);
    setup->box_low[k] = number(s, name);
    snprintf(name, sizeof name, "%c_hi", axes[k]);
    setup->box_high[k] = number(s, name);
    if (k >= s->dimension) continue;
    snprintf(name, sizeof name, "gravity_%c", axes[k]);
    setup->gravity[k] = g * number(s, name);
    snprintf(name, sizeof name, "boundary_%c", axes[k]);
    boundary = bplbm_variable(s->wire, name);
    setup->periodic[k] = boundary && !strcmp(boundary, "p");
    snprintf(name, sizeof name, "walls_%c", axes[k]);
    s->walls[k] = number(s, name) != 0.0;
  }
  for (int side = 0; side < 6; ++side) setup->sides[side] = s->walls[side / 2];
  if (s->dimension == 2) setup->depth = number(s, "depth");
  setup->step = number(s, "solid_step");
  setup->steps = (int32_t)number(s, "substeps");
  setup->checkpoints = 1;
  setup->radius[0] = setup->radius[1] = setup->density[0] = setup->density[1] = 0.0;
  if (setup->buoyancy != BPLBM_BUOYANCY_NONE) setup->buoyancy = BPLBM_BUOYANCY_BY_FLUID;

  const double pi = acos(-1.0), r = 0.5 * number(s, "diameter_max"), density = number(s, "density_max");
  s->shape.radius = r;
  s->shape.mass = s->dimension == 2 ? density * pi * r * r * setup->depth : density * 4.0 / 3.0 * pi * r * r * r;
  s->shape.inertia = (s->dimension == 2 ? 0.5 : 0.4) * s->shape.mass * r * r;
  s->shape.type = 1;
  s->shape.carrier = BPLBM_ITSELF;
  s->stiffness = number_or(s, "contact_stiffness", 1e5);
  s->damping = 2.0 * number_or(s, "damping_ratio", 0.5) * sqrt(s->shape.mass * s->stiffness);
}

static void make_room(Solid* s, int64_t n) {
  if (n <= s->room) return;
  s->room = 2 * n;
  s->states = realloc(s->states, sizeof *s->states * (size_t)s->room);
  s->shapes = realloc(s->shapes, sizeof *s->shapes * (size_t)s->room);
  s->loads = realloc(s->loads, sizeof *s->loads * (size_t)s->room);
  s->accelerations = realloc(s->accelerations, sizeof(double) * 3 * (size_t)s->room);
  if (!s->states || !s->shapes || !s->loads || !s->accelerations) {
    bplbm_fail(s->wire, BPLBM_FAULT, "there is no memory for the particles");
    exit(bplbm_close(s->wire));
  }
}

static void add(Solid* s, const bplbm_state* state) {
  make_room(s, s->n + 1);
  s->states[s->n] = *state;
  s->shapes[s->n] = s->shape;
  s->shapes[s->n].id = state->id;
  ++s->n;
}

static void take_out(Solid* s, int64_t id) {
  for (int64_t i = 0; i < s->n; ++i)
    if (s->states[i].id == id) {
      --s->n;
      memmove(s->states + i, s->states + i + 1, sizeof *s->states * (size_t)(s->n - i));
      memmove(s->shapes + i, s->shapes + i + 1, sizeof *s->shapes * (size_t)(s->n - i));
      return;
    }
}

/* Puts the particles of an interval into the box: particle1_x, …; those without particle1_interval at the beginning.
   Takes out those whose particle1_until it is. */
static void insert(Solid* s, int64_t interval) {
  static const char axes[] = "xyz";
  char name[40];
  for (int64_t i = 1;; ++i) {
    bplbm_state state = {.id = i};
    snprintf(name, sizeof name, "particle%lld_x", (long long)i);
    if (!bplbm_variable(s->wire, name)) return;
    snprintf(name, sizeof name, "particle%lld_until", (long long)i);
    if ((int64_t)number_or(s, name, -1.0) == interval) take_out(s, i);
    snprintf(name, sizeof name, "particle%lld_interval", (long long)i);
    if ((int64_t)number_or(s, name, 0.0) != interval) continue;
    for (int k = 0; k < s->dimension; ++k) {
      snprintf(name, sizeof name, "particle%lld_%c", (long long)i, axes[k]);
      state.x[k] = number(s, name);
      snprintf(name, sizeof name, "particle%lld_v%c", (long long)i, axes[k]);
      state.v[k] = number_or(s, name, 0.0);
    }
    add(s, &state);
  }
}

/* A checkpoint is the list of states: every path is decided by places and velocities, so a restart goes on to the bit. */
static void read_checkpoint(Solid* s, const char* file) {
  FILE* in = file ? fopen(file, "rb") : NULL;
  bplbm_state state;
  size_t rest = 1;
  if (in)
    while ((rest = fread(&state, 1, sizeof state, in)) == sizeof state) add(s, &state);
  if (in) fclose(in);
  if (rest != 0) bplbm_fail(s->wire, BPLBM_BAD_INPUT, "the restart file is no checkpoint of this engine");
}

/* Force of a contact along its normal: never a pull. */
static double push(const Solid* s, double overlap, double approach) {
  const double force = s->stiffness * overlap + s->damping * approach;
  return overlap > 0.0 && force > 0.0 ? force : 0.0;
}

static void collide(Solid* s, int64_t i, int64_t j) {
  const bplbm_state *a = &s->states[i], *b = &s->states[j];
  double n[3] = {0.0}, distance = 0.0, approach = 0.0;
  for (int k = 0; k < s->dimension; ++k) {
    const double length = s->setup.box_high[k] - s->setup.box_low[k];
    n[k] = a->x[k] - b->x[k];
    if (s->setup.periodic[k]) n[k] -= length * round(n[k] / length);
    distance += n[k] * n[k];
  }
  distance = sqrt(distance);
  if (distance >= 2.0 * s->shape.radius) return;
  for (int k = 0; k < s->dimension; ++k) approach -= (a->v[k] - b->v[k]) * n[k] / distance;
  const double force = push(s, 2.0 * s->shape.radius - distance, approach);
  for (int k = 0; k < s->dimension; ++k) {
    s->accelerations[3 * i + k] += force * n[k] / distance / s->shape.mass;
    s->accelerations[3 * j + k] -= force * n[k] / distance / s->shape.mass;
  }
}

static void accelerate(Solid* s) {
  const double r = s->shape.radius, m = s->shape.mass;
  for (int64_t i = 0; i < s->n; ++i) {
    const bplbm_state* p = &s->states[i];
    for (int k = 0; k < 3; ++k) s->accelerations[3 * i + k] = 0.0;
    for (int k = 0; k < s->dimension; ++k) {
      double* a = &s->accelerations[3 * i + k];
      *a += s->setup.gravity[k] + s->loads[i].force[k] / m;
      if (!s->walls[k]) continue;
      *a += push(s, r - (p->x[k] - s->setup.box_low[k]), -p->v[k]) / m;
      *a -= push(s, r - (s->setup.box_high[k] - p->x[k]), p->v[k]) / m;
    }
  }
  for (int64_t i = 0; i < s->n; ++i)
    for (int64_t j = 0; j < i; ++j) collide(s, i, j);
}

/* @return whether the particle is still in the box */
static int put_into_box(const Solid* s, bplbm_state* p) {
  for (int k = 0; k < s->dimension; ++k) {
    const double low = s->setup.box_low[k], high = s->setup.box_high[k];
    if (s->setup.periodic[k])
      p->x[k] -= (high - low) * floor((p->x[k] - low) / (high - low));
    else if (p->x[k] < low || p->x[k] > high)
      return 0;
  }
  return 1;
}

/* The steps of an interval under one load each; what leaves an open box is gone. */
static void advance(Solid* s) {
  const double dt = s->setup.step;
  int64_t kept = 0;
  accelerate(s);
  for (int32_t step = 0; step < s->setup.steps; ++step) {
    for (int64_t i = 0; i < s->n; ++i)
      for (int k = 0; k < s->dimension; ++k) {
        s->states[i].v[k] += 0.5 * dt * s->accelerations[3 * i + k];
        s->states[i].x[k] += dt * s->states[i].v[k];
      }
    accelerate(s);
    for (int64_t i = 0; i < s->n; ++i)
      for (int k = 0; k < 3; ++k) {
        s->states[i].v[k] += 0.5 * dt * s->accelerations[3 * i + k];
        if (s->dimension == 3 || k == 2) s->states[i].omega[k] += dt * s->loads[i].torque[k] / s->shape.inertia;
      }
  }
  for (int64_t i = 0; i < s->n; ++i) {
    bplbm_state p = s->states[i];
    if (!put_into_box(s, &p)) continue;
    s->states[kept] = p;
    s->shapes[kept++] = s->shapes[i];
  }
  s->n = kept;
}

/* Speaks for this rank's share of the particles, and brings the loads of all to every rank. */
static int exchange(Solid* s, uint32_t* asked) {
  int64_t mine = 0;
  if (s->ranks == 1) return bplbm_exchange(s->wire, s->n, s->states, s->shapes, s->loads, asked);
  make_room(s, s->n + 1);
  bplbm_state* states = malloc(sizeof *states * (size_t)(s->n + 1));
  bplbm_shape* shapes = malloc(sizeof *shapes * (size_t)(s->n + 1));
  bplbm_load* loads = malloc(sizeof *loads * (size_t)(s->n + 1));
  double* all = calloc(6 * (size_t)(s->n + 1), sizeof *all);
  for (int64_t i = 0; i < s->n; ++i) {
    if (s->states[i].id % s->ranks != s->rank) continue;
    states[mine] = s->states[i];
    shapes[mine++] = s->shapes[i];
  }
  const int code = bplbm_exchange(s->wire, mine, states, shapes, loads, asked);
  if (code == BPLBM_OK && !(*asked & BPLBM_LAST)) {
    for (int64_t i = 0, m = 0; i < s->n; ++i)
      if (s->states[i].id % s->ranks == s->rank) {
        memcpy(all + 6 * i, loads[m].force, 3 * sizeof *all);
        memcpy(all + 6 * i + 3, loads[m++].torque, 3 * sizeof *all);
      }
    MPI_Allreduce(MPI_IN_PLACE, all, (int)(6 * s->n), MPI_DOUBLE, MPI_SUM, bplbm_communicator(s->wire));
    for (int64_t i = 0; i < s->n; ++i) {
      memcpy(s->loads[i].force, all + 6 * i, 3 * sizeof *all);
      memcpy(s->loads[i].torque, all + 6 * i + 3, 3 * sizeof *all);
    }
  }
  free(states), free(shapes), free(loads), free(all);
  return code;
}

int main(void) {
  Solid s = {0};
  uint32_t asked = 0;
  if (bplbm_connect(&s.wire, "c_engine", "1") != BPLBM_OK) return bplbm_close(s.wire);
  MPI_Comm_size(bplbm_communicator(s.wire), &s.ranks);
  MPI_Comm_rank(bplbm_communicator(s.wire), &s.rank);
  read_scene(&s);
  int64_t interval = s.setup.first_interval;
  if (interval > 0)
    read_checkpoint(&s, bplbm_variable(s.wire, "restart_file"));
  else
    insert(&s, 0);
  s.setup.particles = s.n;
  bplbm_agree(s.wire, &s.setup);
  while (exchange(&s, &asked) == BPLBM_OK && !(asked & BPLBM_LAST)) {
    advance(&s);
    insert(&s, ++interval);
    if (asked & BPLBM_CHECKPOINT) bplbm_checkpoint(s.wire, s.states, s.rank == 0 ? s.n * (int64_t)sizeof *s.states : 0);
  }
  return bplbm_close(s.wire);
}
