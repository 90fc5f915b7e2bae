! Participant contract in Fortran 2018, as a module over libcosim. cosim.h documents the functions.
!
! Compile this file with the program, and link with -lcosim. A program fills a cosim_solver with its
! callbacks (c_funloc) and passes it to cosim_run; proto/c/examples/short_columns.f90 is a complete
! solver.
module cosim
   use, intrinsic :: iso_c_binding
   implicit none
   public

   integer(c_int), parameter :: COSIM_UPPER = 0, COSIM_LOWER = 1
   integer(c_int), parameter :: COSIM_OK = 0, COSIM_REFUSED = 1, COSIM_FAILED = 2
   integer(c_int), parameter :: COSIM_STRUCTURED = 1, COSIM_QUADRILATERALS = 2, COSIM_VERTICES = 3
   integer(c_int32_t), parameter :: COSIM_RECEIVED_POWER = 1, COSIM_WANTED_WINDOW = 2
   integer(c_int32_t), parameter :: COSIM_VERSION = 4

   type, bind(c) :: cosim_step
      integer(c_int64_t) :: window
      integer(c_int32_t) :: iteration
      real(c_double) :: start, end
   end type

   type, bind(c) :: cosim_report
      integer(c_int32_t) :: substeps, inner_iterations
      integer(c_int64_t) :: work
      integer(c_int32_t) :: present
      real(c_double) :: received_power, wanted_window
   end type

   type, bind(c) :: cosim_grid
      character(kind=c_char) :: name(32)
      integer(c_int64_t) :: revision
      integer(c_int) :: kind
      integer(c_size_t) :: points
      real(c_double) :: origin(3), step_i(3), step_j(3)
      integer(c_size_t) :: ni, nj, vertex_count
      type(c_ptr) :: vertices, elements
   end type

   ! cosim_run sets size and version. An omitted callback stays c_null_funptr.
   type, bind(c) :: cosim_solver
      integer(c_size_t) :: size = 0
      integer(c_int32_t) :: version = 0
      type(c_funptr) :: describe = c_null_funptr, configure = c_null_funptr, build = c_null_funptr
      type(c_funptr) :: first_outputs = c_null_funptr, solve = c_null_funptr, accept = c_null_funptr
      type(c_funptr) :: observe = c_null_funptr, save = c_null_funptr, restore = c_null_funptr
      type(c_funptr) :: summary = c_null_funptr, destroy = c_null_funptr
      type(c_funptr) :: moved_grids = c_null_funptr, finish = c_null_funptr
   end type

   interface
      function cosim_main(argc, argv, solver, user) bind(c) result(code)
         import
         integer(c_int), value :: argc
         type(c_ptr), intent(in) :: argv(*)
         type(cosim_solver), intent(in) :: solver
         type(c_ptr), value :: user
         integer(c_int) :: code
      end function

      function cosim_model(configuration) bind(c) result(name)
         import
         type(c_ptr), value :: configuration
         type(c_ptr) :: name
      end function

      function cosim_is_transient(configuration) bind(c) result(transient)
         import
         type(c_ptr), value :: configuration
         logical(c_bool) :: transient
      end function

      function cosim_threads(configuration) bind(c) result(threads)
         import
         type(c_ptr), value :: configuration
         integer(c_size_t) :: threads
      end function

      function cosim_has_effect(configuration, effect) bind(c) result(active)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: effect(*)
         logical(c_bool) :: active
      end function

      function cosim_is_wanted(configuration, field) bind(c) result(wanted)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: field(*)
         logical(c_bool) :: wanted
      end function

      function cosim_case_has(configuration, key) bind(c) result(there)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: key(*)
         logical(c_bool) :: there
      end function

      function cosim_case_number(configuration, key, number) bind(c) result(status)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: key(*)
         real(c_double), intent(inout) :: number
         integer(c_int) :: status
      end function

      function cosim_case_integer(configuration, key, number) bind(c) result(status)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: key(*)
         integer(c_int64_t), intent(inout) :: number
         integer(c_int) :: status
      end function

      function cosim_case_flag(configuration, key, flag) bind(c) result(status)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: key(*)
         logical(c_bool), intent(inout) :: flag
         integer(c_int) :: status
      end function

      function cosim_case_text(configuration, key) bind(c) result(text)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: key(*)
         type(c_ptr) :: text
      end function

      function cosim_body_name(configuration, body) bind(c) result(name)
         import
         type(c_ptr), value :: configuration
         integer(c_int), value :: body
         type(c_ptr) :: name
      end function

      function cosim_input_grid(configuration, field, grid) bind(c) result(known)
         import
         type(c_ptr), value :: configuration
         character(kind=c_char), intent(in) :: field(*)
         type(cosim_grid), intent(out) :: grid
         logical(c_bool) :: known
      end function

      function cosim_refuse(key, reason, fix) bind(c) result(status)
         import
         character(kind=c_char), intent(in) :: key(*), reason(*), fix(*)
         integer(c_int) :: status
      end function

      function cosim_fail(message) bind(c) result(status)
         import
         character(kind=c_char), intent(in) :: message(*)
         integer(c_int) :: status
      end function

      ! count and grid are optional.
      function cosim_input(inputs, field, count, grid) bind(c) result(values)
         import
         type(c_ptr), value :: inputs
         character(kind=c_char), intent(in) :: field(*)
         integer(c_size_t), intent(out), optional :: count
         type(cosim_grid), intent(out), optional :: grid
         type(c_ptr) :: values
      end function

      function cosim_input_start(inputs, field, count) bind(c) result(values)
         import
         type(c_ptr), value :: inputs
         character(kind=c_char), intent(in) :: field(*)
         integer(c_size_t), intent(out), optional :: count
         type(c_ptr) :: values
      end function

      function cosim_require_input(inputs, field, count) bind(c) result(values)
         import
         type(c_ptr), value :: inputs
         character(kind=c_char), intent(in) :: field(*)
         integer(c_size_t), value :: count
         type(c_ptr) :: values
      end function

      function cosim_output(outputs, field, count) bind(c) result(values)
         import
         type(c_ptr), value :: outputs
         character(kind=c_char), intent(in) :: field(*)
         integer(c_size_t), intent(out), optional :: count
         type(c_ptr) :: values
      end function

      function cosim_blob_write(blob, bytes, size) bind(c) result(status)
         import
         type(c_ptr), value :: blob, bytes
         integer(c_size_t), value :: size
         integer(c_int) :: status
      end function

      function cosim_blob_read(blob, bytes, size) bind(c) result(status)
         import
         type(c_ptr), value :: blob, bytes
         integer(c_size_t), value :: size
         integer(c_int) :: status
      end function

      function cosim_layout_grid(layout, grid) bind(c) result(status)
         import
         type(c_ptr), value :: layout
         type(cosim_grid), intent(in) :: grid
         integer(c_int) :: status
      end function

      function cosim_layout_output(layout, field, grid) bind(c) result(status)
         import
         type(c_ptr), value :: layout
         character(kind=c_char), intent(in) :: field(*), grid(*)
         integer(c_int) :: status
      end function

      function cosim_layout_input(layout, field, grid) bind(c) result(status)
         import
         type(c_ptr), value :: layout
         character(kind=c_char), intent(in) :: field(*), grid(*)
         integer(c_int) :: status
      end function

      function cosim_layout_cost(layout, solve_seconds, memory_bytes) bind(c) result(status)
         import
         type(c_ptr), value :: layout
         real(c_double), value :: solve_seconds
         integer(c_int64_t), value :: memory_bytes
         integer(c_int) :: status
      end function

      function cosim_layout_remark(layout, remark) bind(c) result(status)
         import
         type(c_ptr), value :: layout
         character(kind=c_char), intent(in) :: remark(*)
         integer(c_int) :: status
      end function

      function cosim_progress(done, of, what) bind(c) result(status)
         import
         integer(c_int64_t), value :: done, of
         character(kind=c_char), intent(in) :: what(*)
         integer(c_int) :: status
      end function
   end interface

contains

   ! Complete main of a participant: cosim_main with the command line. Returns the exit code.
   function cosim_run(solver, user) result(code)
      type(cosim_solver), intent(in) :: solver
      type(c_ptr), intent(in) :: user
      integer(c_int) :: code
      type(cosim_solver) :: filled
      character(kind=c_char, len=:), allocatable, target :: words
      type(c_ptr), allocatable :: argv(:)
      integer, allocatable :: first(:)
      integer :: n, length

      allocate (argv(command_argument_count() + 2), first(command_argument_count() + 1))
      words = ''
      do n = 1, size(first)
         call get_command_argument(n - 1, length=length)
         first(n) = len(words) + 1
         words = words//repeat(c_null_char, length + 1)
         call get_command_argument(n - 1, words(first(n):first(n) + length - 1))
      end do
      do n = 1, size(first)
         argv(n) = c_loc(words(first(n):first(n)))
      end do
      argv(size(argv)) = c_null_ptr
      filled = solver
      filled%size = c_sizeof(filled)
      filled%version = COSIM_VERSION
      code = cosim_main(int(size(first), c_int), argv, filled, user)
   end function

   ! Returns the words as a C string.
   pure function c_text(words) result(text)
      character(len=*), intent(in) :: words
      character(kind=c_char, len=len_trim(words) + 1) :: text
      text = trim(words)//c_null_char
   end function

   ! Returns a C string as words; empty for a null pointer.
   function words_of(text) result(words)
      type(c_ptr), intent(in) :: text
      character(len=:), allocatable :: words
      character(kind=c_char), pointer :: letters(:)
      integer :: n

      words = ''
      if (.not. c_associated(text)) return
      call c_f_pointer(text, letters, [huge(0)])
      n = 1
      do while (letters(n) /= c_null_char)
         words = words//letters(n)
         n = n + 1
      end do
   end function
end module
