! SPDX-License-Identifier: MIT
! The solid's side of a coupled job for Fortran: bplbm_solid.h, with the same names and meanings. Compile this file with
! your own compiler, since modules of one compiler cannot be read by another. Texts are ordinary character variables.
module bplbm_solid
  use, intrinsic :: iso_c_binding
  implicit none
  private
  public :: bplbm_setup, bplbm_state, bplbm_shape, bplbm_load
  public :: bplbm_connect, bplbm_error, bplbm_scene, bplbm_has, bplbm_text, bplbm_number, bplbm_clump, bplbm_agree
  public :: bplbm_exchange, bplbm_send, bplbm_receive, bplbm_checkpoint, bplbm_goodbye, bplbm_fail, bplbm_communicator, bplbm_close

  integer(c_int), parameter, public :: BPLBM_OK = 0, BPLBM_FAULT = 1, BPLBM_BAD_INPUT = 2, BPLBM_NUMERICS = 3
  integer(c_int32_t), parameter, public :: BPLBM_LAST = 1, BPLBM_STOP = 2, BPLBM_CHECKPOINTS = 4, BPLBM_WANT_BONDS = 8, &
                                           BPLBM_SETTLE = 16  ! what the fluid asks for: test with iand
  integer(c_int32_t), parameter, public :: BPLBM_BUOYANCY_BY_FLUID = 0, BPLBM_BUOYANCY_BY_SOLID = 1, BPLBM_BUOYANCY_NONE = 2
  integer(c_int64_t), parameter, public :: BPLBM_ITSELF = -1

  type, bind(c) :: bplbm_setup
    integer(c_int32_t) :: dimension = 2, periodic(3) = 0
    real(c_double) :: box_low(3) = 0, box_high(3) = 0, depth = 1, gravity(3) = 0
    integer(c_int32_t) :: buoyancy = 0, schedule = 0
    real(c_double) :: step = 0
    integer(c_int32_t) :: steps = 1, checkpoints = 0
    integer(c_int64_t) :: first_interval = 0, particles = -1
    real(c_double) :: radius(2) = 0, density(2) = 0
    integer(c_int32_t) :: sides(6) = -1
  end type

  type, bind(c) :: bplbm_state
    integer(c_int64_t) :: id = 0
    real(c_double) :: x(3) = 0, v(3) = 0, omega(3) = 0
  end type

  type, bind(c) :: bplbm_shape
    integer(c_int64_t) :: id = 0
    real(c_double) :: radius = 0, mass = 0, inertia = 0
    integer(c_int64_t) :: type = 1, epoch = 0, carrier = BPLBM_ITSELF
    real(c_double) :: volume = 0
  end type

  type, bind(c) :: bplbm_load
    integer(c_int64_t) :: id = 0
    real(c_double) :: force(3) = 0, torque(3) = 0
  end type

  interface
    integer(c_int) function c_connect(solid, program, version) bind(c, name="bplbm_connect")
      import
      type(c_ptr) :: solid
      character(kind=c_char), intent(in) :: program(*), version(*)
    end function
    type(c_ptr) function c_error(solid) bind(c, name="bplbm_error")
      import
      type(c_ptr), value :: solid
    end function
    integer(c_int) function bplbm_scene(solid, setup) bind(c)
      import
      type(c_ptr), value :: solid
      type(bplbm_setup), intent(out) :: setup
    end function
    type(c_ptr) function c_variable(solid, name) bind(c, name="bplbm_variable")
      import
      type(c_ptr), value :: solid
      character(kind=c_char), intent(in) :: name(*)
    end function
    integer(c_int) function c_number(solid, name, value) bind(c, name="bplbm_number")
      import
      type(c_ptr), value :: solid
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), intent(inout) :: value
    end function
    integer(c_int) function bplbm_clump(solid, n, places, radii, density, carrier, centre, inertia) bind(c)
      import
      type(c_ptr), value :: solid
      integer(c_int64_t), value :: n
      real(c_double), intent(in) :: places(3, *), radii(*)
      real(c_double), value :: density
      type(bplbm_shape), intent(inout) :: carrier
      real(c_double), intent(inout) :: centre(3), inertia(6)
    end function
    integer(c_int) function bplbm_agree(solid, setup) bind(c)
      import
      type(c_ptr), value :: solid
      type(bplbm_setup), intent(in) :: setup
    end function
    integer(c_int) function bplbm_exchange(solid, n, states, shapes, loads, asked) bind(c)
      import
      type(c_ptr), value :: solid
      integer(c_int64_t), value :: n
      type(bplbm_state), intent(in) :: states(*)
      type(bplbm_shape), intent(in) :: shapes(*)
      type(bplbm_load), intent(inout) :: loads(*)
      integer(c_int32_t), intent(inout) :: asked
    end function
    integer(c_int) function bplbm_send(solid, n, states, shapes) bind(c)
      import
      type(c_ptr), value :: solid
      integer(c_int64_t), value :: n
      type(bplbm_state), intent(in) :: states(*)
      type(bplbm_shape), intent(in) :: shapes(*)
    end function
    integer(c_int) function bplbm_receive(solid, loads, asked) bind(c)
      import
      type(c_ptr), value :: solid
      type(bplbm_load), intent(inout) :: loads(*)
      integer(c_int32_t), intent(inout) :: asked
    end function
    integer(c_int) function bplbm_checkpoint(solid, bytes, size) bind(c)
      import
      type(c_ptr), value :: solid, bytes  ! c_loc of a variable with the attribute target
      integer(c_int64_t), value :: size   ! in bytes
    end function
    integer(c_int) function c_goodbye(solid, reason) bind(c, name="bplbm_goodbye")
      import
      type(c_ptr), value :: solid
      character(kind=c_char), intent(in) :: reason(*)
    end function
    integer(c_int) function c_fail(solid, code, reason) bind(c, name="bplbm_fail")
      import
      type(c_ptr), value :: solid
      integer(c_int), value :: code
      character(kind=c_char), intent(in) :: reason(*)
    end function
    integer(c_int) function bplbm_communicator(solid) bind(c, name="bplbm_communicator_f")
      import
      type(c_ptr), value :: solid
    end function
    integer(c_int) function bplbm_close(solid) bind(c)
      import
      type(c_ptr), value :: solid
    end function
    integer(c_size_t) function c_strlen(text) bind(c, name="strlen")
      import
      type(c_ptr), value :: text
    end function
  end interface

contains

  integer(c_int) function bplbm_connect(solid, program, version)
    type(c_ptr), intent(out) :: solid
    character(*), intent(in) :: program, version
    bplbm_connect = c_connect(solid, trim(program) // c_null_char, trim(version) // c_null_char)
  end function

  function bplbm_error(solid) result(text)
    type(c_ptr), intent(in) :: solid
    character(:), allocatable :: text
    text = text_at(c_error(solid))
  end function

  ! Whether the scene offers a variable.
  logical function bplbm_has(solid, name)
    type(c_ptr), intent(in) :: solid
    character(*), intent(in) :: name
    bplbm_has = c_associated(c_variable(solid, trim(name) // c_null_char))
  end function

  ! A variable of the scene as text (bplbm_variable in C); empty where there is none.
  function bplbm_text(solid, name) result(text)
    type(c_ptr), intent(in) :: solid
    character(*), intent(in) :: name
    character(:), allocatable :: text
    text = text_at(c_variable(solid, trim(name) // c_null_char))
  end function

  integer(c_int) function bplbm_number(solid, name, value)
    type(c_ptr), intent(in) :: solid
    character(*), intent(in) :: name
    real(c_double), intent(inout) :: value
    bplbm_number = c_number(solid, trim(name) // c_null_char, value)
  end function

  integer(c_int) function bplbm_goodbye(solid, reason)
    type(c_ptr), intent(in) :: solid
    character(*), intent(in) :: reason
    bplbm_goodbye = c_goodbye(solid, trim(reason) // c_null_char)
  end function

  integer(c_int) function bplbm_fail(solid, code, reason)
    type(c_ptr), intent(in) :: solid
    integer(c_int), intent(in) :: code
    character(*), intent(in) :: reason
    bplbm_fail = c_fail(solid, code, trim(reason) // c_null_char)
  end function

  function text_at(pointer) result(text)
    type(c_ptr), intent(in) :: pointer
    character(:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    text = ""
    if (.not. c_associated(pointer)) return
    call c_f_pointer(pointer, letters, [c_strlen(pointer)])
    do i = 1, size(letters)
      text = text // letters(i)
    end do
  end function

end module
