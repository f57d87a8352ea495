! SPDX-License-Identifier: MIT
! A small solid program in Fortran, on one rank: soft discs or spheres under gravity, with linear springs and dashpots
! between them and with the walls of the box. Everything that it needs comes as variables of the fluid's scene.
!
!   F_n = k d - g v_n,  g = 2 xi sqrt(m k);  velocity Verlet, in which the load of an interval acts in each of its steps
module particles
  use, intrinsic :: iso_c_binding
  use bplbm_solid
  implicit none
  character, parameter :: axes(3) = ["x", "y", "z"]

  type(c_ptr) :: wire = c_null_ptr
  type(bplbm_setup) :: setup
  type(bplbm_shape) :: shape_of_all
  type(bplbm_state), allocatable, target :: states(:)
  type(bplbm_shape), allocatable :: shapes(:)
  type(bplbm_load), allocatable :: loads(:)
  real(c_double), allocatable :: a(:, :)  ! acceleration of each [m/s^2]
  real(c_double) :: stiffness, damping
  integer :: dims
  logical :: walls(3) = .false.

contains

  real(c_double) function number(name, otherwise)
    character(*), intent(in) :: name
    real(c_double), intent(in), optional :: otherwise
    integer(c_int) :: code
    number = 0
    if (present(otherwise)) number = otherwise
    if (present(otherwise) .and. .not. bplbm_has(wire, name)) return
    code = bplbm_number(wire, name, number)
  end function

  subroutine read_scene
    real(c_double), parameter :: pi = acos(-1.0_c_double)
    real(c_double) :: r, density
    integer(c_int) :: code
    integer :: k
    code = bplbm_scene(wire, setup)
    dims = setup%dimension
    do k = 1, 3
      setup%box_low(k) = number(axes(k) // "_lo")
      setup%box_high(k) = number(axes(k) // "_hi")
      if (k > dims) cycle
      setup%gravity(k) = number("gravity") * number("gravity_" // axes(k))
      setup%periodic(k) = merge(1, 0, bplbm_text(wire, "boundary_" // axes(k)) == "p")
      walls(k) = number("walls_" // axes(k)) /= 0
    end do
    setup%sides = [(merge(1, 0, walls((k + 1) / 2)), k = 1, 6)]
    if (dims == 2) setup%depth = number("depth")
    setup%step = number("solid_step")
    setup%steps = int(number("substeps"))
    setup%checkpoints = 1
    setup%radius = 0
    setup%density = 0
    if (setup%buoyancy /= BPLBM_BUOYANCY_NONE) setup%buoyancy = BPLBM_BUOYANCY_BY_FLUID

    r = 0.5_c_double * number("diameter_max")
    density = number("density_max")
    shape_of_all%radius = r
    shape_of_all%mass = density * merge(pi * r**2 * setup%depth, 4 * pi * r**3 / 3, dims == 2)
    shape_of_all%inertia = merge(0.5_c_double, 0.4_c_double, dims == 2) * shape_of_all%mass * r**2
    stiffness = number("contact_stiffness", 1e5_c_double)
    damping = 2 * number("damping_ratio", 0.5_c_double) * sqrt(shape_of_all%mass * stiffness)
  end subroutine

  subroutine add(state)
    type(bplbm_state), intent(in) :: state
    states = [states, state]
    shapes = [shapes, shape_of_all]
    shapes(size(shapes))%id = state%id
  end subroutine

  ! Puts the particles of an interval into the box: particle1_x, …
  subroutine insert(interval)
    integer(c_int64_t), intent(in) :: interval
    type(bplbm_state) :: state
    character(40) :: name
    integer :: i, k
    do i = 1, huge(1) - 1
      write (name, "(a, i0, a)") "particle", i, "_"
      if (.not. bplbm_has(wire, trim(name) // "x")) return
      if (int(number(trim(name) // "until", -1.0_c_double), c_int64_t) == interval) then  ! it is taken out
        shapes = pack(shapes, states%id /= i)
        states = pack(states, states%id /= i)
      end if
      if (int(number(trim(name) // "interval", 0.0_c_double), c_int64_t) /= interval) cycle
      state = bplbm_state(id=i)
      do k = 1, dims
        state%x(k) = number(trim(name) // axes(k))
        state%v(k) = number(trim(name) // "v" // axes(k), 0.0_c_double)
      end do
      call add(state)
    end do
  end subroutine

  ! A checkpoint is the list of states: every path is decided by places and velocities.
  subroutine read_checkpoint
    type(bplbm_state) :: state
    integer :: file, status, bytes
    integer(c_int) :: code
    open (newunit=file, file=bplbm_text(wire, "restart_file"), access="stream", form="unformatted", status="old", &
          iostat=status)
    if (status == 0) then
      inquire (unit=file, size=bytes)
      if (mod(bytes, int(c_sizeof(state))) /= 0) status = 1
      do while (status == 0)
        read (file, iostat=status) state%id, state%x, state%v, state%omega
        if (status == 0) call add(state)
      end do
      if (is_iostat_end(status)) status = 0
    end if
    if (status /= 0) code = bplbm_fail(wire, BPLBM_BAD_INPUT, "the restart file is no checkpoint of this engine")
  end subroutine

  ! Force of a contact along its normal: never a pull.
  pure real(c_double) function push(overlap, approach)
    real(c_double), intent(in) :: overlap, approach
    push = 0
    if (overlap > 0) push = max(0.0_c_double, stiffness * overlap + damping * approach)
  end function

  subroutine accelerate
    real(c_double) :: n(3), distance, force, length(3), r, m
    integer :: i, j, k
    r = shape_of_all%radius
    m = shape_of_all%mass
    length = setup%box_high - setup%box_low
    a = spread([0.0_c_double, 0.0_c_double, 0.0_c_double], 2, size(states))
    do i = 1, size(states)
      associate (p => states(i))
        do k = 1, dims
          a(k, i) = setup%gravity(k) + loads(i)%force(k) / m
          if (.not. walls(k)) cycle
          a(k, i) = a(k, i) + push(r - (p%x(k) - setup%box_low(k)), -p%v(k)) / m
          a(k, i) = a(k, i) - push(r - (setup%box_high(k) - p%x(k)), p%v(k)) / m
        end do
      end associate
    end do
    do i = 2, size(states)
      do j = 1, i - 1
        n = states(i)%x - states(j)%x
        where (setup%periodic == 1) n = n - length * anint(n / length)
        n(dims + 1:) = 0
        distance = norm2(n)
        if (distance >= 2 * r) cycle
        n = n / distance
        force = push(2 * r - distance, -dot_product(states(i)%v - states(j)%v, n))
        a(:, i) = a(:, i) + force * n / m
        a(:, j) = a(:, j) - force * n / m
      end do
    end do
  end subroutine

  ! The steps of an interval under one load each; what leaves an open box is gone.
  subroutine advance
    logical, allocatable :: inside(:)
    real(c_double) :: length
    integer :: i, k, step
    call accelerate
    do step = 1, setup%steps
      do i = 1, size(states)
        states(i)%v = states(i)%v + 0.5_c_double * setup%step * a(:, i)
        states(i)%x = states(i)%x + setup%step * states(i)%v
      end do
      call accelerate
      do i = 1, size(states)
        states(i)%v = states(i)%v + 0.5_c_double * setup%step * a(:, i)
        do k = merge(3, 1, dims == 2), 3
          states(i)%omega(k) = states(i)%omega(k) + setup%step * loads(i)%torque(k) / shapes(i)%inertia
        end do
      end do
    end do
    allocate (inside(size(states)), source=.true.)
    do k = 1, dims
      length = setup%box_high(k) - setup%box_low(k)
      if (setup%periodic(k) == 1) then
        states%x(k) = states%x(k) - length * floor((states%x(k) - setup%box_low(k)) / length)
      else
        inside = inside .and. states%x(k) >= setup%box_low(k) .and. states%x(k) <= setup%box_high(k)
      end if
    end do
    shapes = pack(shapes, inside)
    states = pack(states, inside)
  end subroutine

end module

program engine
  use particles
  implicit none
  integer(c_int) :: code
  integer(c_int32_t) :: asked
  integer(c_int64_t) :: interval
  allocate (states(0), shapes(0))
  asked = 0
  code = bplbm_connect(wire, "fortran_engine", "1")
  if (code == BPLBM_OK) then
    call read_scene
    interval = setup%first_interval
    if (interval > 0) call read_checkpoint
    if (interval == 0) call insert(interval)
    setup%particles = size(states)
    code = bplbm_agree(wire, setup)
    do
      if (allocated(loads)) deallocate (loads)
      allocate (loads(size(states)))
      code = bplbm_exchange(wire, size(states, kind=c_int64_t), states, shapes, loads, asked)
      if (code /= BPLBM_OK .or. iand(asked, BPLBM_LAST) /= 0) exit
      call advance
      interval = interval + 1
      call insert(interval)
      if (iand(asked, BPLBM_CHECKPOINTS) /= 0) &
        code = bplbm_checkpoint(wire, c_loc(states), size(states) * c_sizeof(states(1)))
    end do
  end if
  code = bplbm_close(wire)
  call leave(int(code))

contains

  ! The exit code of the process, without Fortran's own message.
  subroutine leave(exit_code)
    integer, intent(in) :: exit_code
    interface
      subroutine c_exit(exit_code) bind(c, name="exit")
        import c_int
        integer(c_int), value :: exit_code
      end subroutine
    end interface
    flush (6)
    call c_exit(int(exit_code, c_int))
  end subroutine

end program
