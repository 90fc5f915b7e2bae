! A complete thermal solver in Fortran: heat conduction normal to the surface, in strips.
!
!     T(x) = 1/(beta sqrt(pi V)) int q/2 dx'/sqrt(x' - x)  upstream,
!
! with q constant over elements and half of the heat flowing into each body; beta is a body's
! effusivity, V the speed of its surface through the contact (Carslaw & Jaeger, Conduction of Heat
! in Solids, 2.9).
module short_columns_callbacks
   use cosim
   implicit none
   private
   public :: columns, solver

   type :: columns
      type(cosim_grid) :: grid             ! of the flux and of both temperatures
      character(len=32) :: name(2)         ! of the lower and the upper body
      real(c_double) :: scale(2)           ! 1/(beta sqrt(pi)) of the lower and the upper body [K m^2/(W sqrt(s))]
      real(c_double), allocatable :: shape(:) ! int dx'/(2 sqrt(x' - x)) over the element itself, the next upstream, ... [sqrt(m)]
      real(c_double), allocatable :: trial(:) ! sums over the elements upstream [W/m^1.5], and behind them for the
      !                                         lower and the upper body the factor 1/(beta sqrt(pi V)) to its rise
      real(c_double), allocatable :: accepted(:)
   end type

   character(len=*), parameter :: SURFACE(2) = ['lower_temperature', 'upper_temperature']
   character(kind=c_char), allocatable, target, save :: description(:), summary_text(:)

contains

   ! Returns the table of callbacks.
   function solver() result(all)
      type(cosim_solver) :: all
      description = letters(description_text())
      all%describe = c_funloc(describe)
      all%configure = c_funloc(configure)
      all%build = c_funloc(build)
      all%solve = c_funloc(solve)
      all%accept = c_funloc(accept)
      all%observe = c_funloc(observe)
      all%save = c_funloc(save_state)
      all%restore = c_funloc(restore_state)
      all%summary = c_funloc(summary)
   end function

   function description_text() result(text)
      character(len=:), allocatable :: text
      character(len=*), parameter :: FIELDS = '"consumes": ["friction_power", "surface_speed"], '// &
         '"provides": ["lower_temperature", "upper_temperature"]'
      text = '{"name": "short-columns", "version": "1.0", "role": "thermal", '// &
         '"reusable": true, "models": [{"name": "short", '// &
         '"steady": true, "transient": false, "summary": "Abel''s integral", '// &
         '"source": "Carslaw & Jaeger, Conduction of Heat in Solids, 2.9", '//FIELDS//'}], '// &
         '"effects": [{"name": "friction_heat", "models": ["short"], "law": "q/2 into each body", '// &
         '"source": "symmetry", '//FIELDS//', "keys": [{"path": "effects.friction_heat.partition", '// &
         '"type": "choice", "of": ["equal"], "default": "equal", "help": "one half each"}]}], "keys": ['// &
         '{"path": "bodies.*.position", "type": "choice", "of": ["upper", "lower"], "required": true, '// &
         '"help": "which of the two bodies it is"}, {"path": "bodies.*.material", "type": "name-in", '// &
         '"table": "materials", "required": true, "help": "material of the body"}, '// &
         quantity('materials.*.density', 'kg/m3', 'density')//', '// &
         quantity('materials.*.specific_heat', 'J/(kg K)', 'specific heat')//', '// &
         quantity('materials.*.conductivity', 'W/(m K)', 'conductivity')//'], "figures": [{'// &
         '"key": "temperature.*.max_rise_k", "unit": "K", "words": "temperature rise", "line": "*", '// &
         '"style": "signed", "headline": true, "rank": 1}]}'
   end function

   pure function quantity(path, unit, help) result(text)
      character(len=*), intent(in) :: path, unit, help
      character(len=:), allocatable :: text
      text = '{"path": "'//path//'", "type": "quantity", "unit": "'//unit// &
         '", "required": true, "above": 0, "help": "'//help//'"}'
   end function

   ! Returns the words as a C string.
   pure function letters(words)
      character(len=*), intent(in) :: words
      character(kind=c_char) :: letters(len(words) + 1)
      letters = transfer(words//c_null_char, letters)
   end function

   function describe(user) bind(c) result(text)
      type(c_ptr), value :: user
      type(c_ptr) :: text
      text = c_loc(description)
   end function

   function read_body(told, body, kept, scale) result(status)
      type(c_ptr), intent(in) :: told
      integer(c_int), intent(in) :: body
      character(len=32), intent(out) :: kept
      real(c_double), intent(out) :: scale
      integer(c_int) :: status
      character(len=*), parameter :: PROPERTY(3) = ['density      ', 'specific_heat', 'conductivity ']
      real(c_double), parameter :: PI = acos(-1.0_c_double)
      character(len=:), allocatable :: name, material
      real(c_double) :: factor
      integer :: p

      scale = PI
      status = COSIM_REFUSED
      name = words_of(cosim_body_name(told, body))
      kept = name
      if (name == '') return
      material = words_of(cosim_case_text(told, c_text('bodies.'//name//'.material')))
      if (material == '') return
      do p = 1, 3
         status = cosim_case_number(told, c_text('materials.'//material//'.'//PROPERTY(p)), factor)
         if (status /= COSIM_OK) return
         scale = scale*factor
      end do
      scale = 1/sqrt(scale)
   end function

   function configure(user, told, layout) bind(c) result(status)
      type(c_ptr), value :: user, told, layout
      integer(c_int) :: status
      type(columns), pointer :: c
      integer :: body

      call c_f_pointer(user, c)
      status = read_body(told, COSIM_LOWER, c%name(1), c%scale(1))
      if (status == COSIM_OK) status = read_body(told, COSIM_UPPER, c%name(2), c%scale(2))
      if (status /= COSIM_OK) return
      if (.not. cosim_input_grid(told, c_text('friction_power'), c%grid)) return ! the grid is unknown while planning
      if (c%grid%kind /= COSIM_STRUCTURED) then
         status = cosim_refuse(c_text('mech.model'), c_text('its grid has no rows along x'), &
                               c_text('name a model whose grid is structured'))
         return
      end if
      status = cosim_layout_grid(layout, c%grid)
      do body = 1, 2
         if (status == COSIM_OK) status = cosim_layout_output(layout, c_text(SURFACE(body)), c%grid%name)
      end do
      if (status == COSIM_OK) status = cosim_layout_cost(layout, 1e-9_c_double*c%grid%points*c%grid%ni, &
                                                         8*(2*c%grid%points + c%grid%ni))
   end function

   function build(user) bind(c) result(status)
      type(c_ptr), value :: user
      integer(c_int) :: status
      type(columns), pointer :: c
      integer :: k

      call c_f_pointer(user, c)
      associate (ni => c%grid%ni, h => c%grid%step_i(1))
         c%shape = [(sqrt((k + 0.5_c_double)*h) - sqrt(max(k - 0.5_c_double, 0.0_c_double)*h), k=0, int(ni) - 1)]
         if (allocated(c%trial)) deallocate (c%trial, c%accepted) ! remains of the previous run
         allocate (c%trial(c%grid%points + 2), c%accepted(c%grid%points + 2))
      end associate
      c%accepted = 0
      status = COSIM_OK
   end function

   ! Rises of a body [K], for the fields and for the summary.
   pure function rises(sums, body) result(values)
      real(c_double), intent(in) :: sums(:)
      integer, intent(in) :: body
      real(c_double) :: values(size(sums) - 2)

      values = sums(size(sums) - 2 + body)*sums(:size(sums) - 2)
   end function

   function write_out(c, sums, outputs) result(status)
      type(columns), intent(in) :: c
      real(c_double), intent(in) :: sums(:)
      type(c_ptr), intent(in) :: outputs
      integer(c_int) :: status
      type(c_ptr) :: place
      real(c_double), pointer :: values(:)
      integer :: body

      do body = 1, 2
         place = cosim_output(outputs, c_text(SURFACE(body)))
         if (.not. c_associated(place)) cycle ! nobody needs the field
         call c_f_pointer(place, values, [c%grid%points])
         values = rises(sums, body)
      end do
      status = COSIM_OK
   end function

   function solve(user, step, inputs, outputs, report) bind(c) result(status)
      type(c_ptr), value :: user, inputs, outputs
      type(cosim_step), intent(in) :: step
      type(cosim_report), intent(inout) :: report
      integer(c_int) :: status
      type(columns), pointer :: c
      type(c_ptr) :: place
      real(c_double), pointer :: power(:, :), speed(:)
      integer :: i, j, ni

      call c_f_pointer(user, c)
      status = COSIM_FAILED
      place = cosim_require_input(inputs, c_text('surface_speed'), 2_c_size_t)
      if (.not. c_associated(place)) return
      call c_f_pointer(place, speed, [2]) ! upper, lower
      if (any(speed <= 0)) then
         status = cosim_fail(c_text('material has to move through the contact: `surface_speed` > 0'))
         return
      end if
      c%trial(c%grid%points + 1:) = c%scale/sqrt(speed(2:1:-1))
      place = cosim_require_input(inputs, c_text('friction_power'), c%grid%points)
      if (.not. c_associated(place)) return
      call c_f_pointer(place, power, [c%grid%ni, c%grid%nj])
      ni = size(power, 1)
      do j = 1, size(power, 2)
         do i = 1, ni
            c%trial((j - 1)*ni + i) = dot_product(power(i:, j), c%shape(:ni - i + 1))
         end do
      end do
      report%substeps = 1
      report%present = COSIM_RECEIVED_POWER
      report%received_power = sum(power)*c%grid%step_i(1)*c%grid%step_j(2)
      status = write_out(c, c%trial, outputs)
   end function

   function accept(user) bind(c) result(status)
      type(c_ptr), value :: user
      integer(c_int) :: status
      type(columns), pointer :: c
      call c_f_pointer(user, c)
      c%accepted = c%trial
      status = COSIM_OK
   end function

   function observe(user, outputs) bind(c) result(status)
      type(c_ptr), value :: user, outputs
      integer(c_int) :: status
      type(columns), pointer :: c
      call c_f_pointer(user, c)
      status = write_out(c, c%accepted, outputs)
   end function

   function summary(user) bind(c) result(text)
      type(c_ptr), value :: user
      type(c_ptr) :: text
      type(columns), pointer :: c
      character(len=256) :: words
      integer :: body

      call c_f_pointer(user, c)
      write (words, '(a, 2(a, es24.16, :, a))') '{"temperature": {', &
         ('"'//trim(c%name(body))//'": {"max_rise_k": ', &
          maxval(rises(c%accepted, body)), &
          merge('}, ', '}}}', body == 1), body=1, 2)
      summary_text = letters(trim(words))
      text = c_loc(summary_text)
   end function

   function save_state(user, blob) bind(c) result(status)
      type(c_ptr), value :: user, blob
      integer(c_int) :: status
      type(columns), pointer :: c
      call c_f_pointer(user, c)
      status = cosim_blob_write(blob, c_loc(c%accepted), 8*(c%grid%points + 2))
   end function

   function restore_state(user, blob) bind(c) result(status)
      type(c_ptr), value :: user, blob
      integer(c_int) :: status
      type(columns), pointer :: c
      call c_f_pointer(user, c)
      status = cosim_blob_read(blob, c_loc(c%accepted), 8*(c%grid%points + 2))
   end function
end module

program main
   use cosim
   use short_columns_callbacks
   implicit none
   type(columns), target :: c
   stop cosim_run(solver(), c_loc(c)), quiet=.true.
end program
