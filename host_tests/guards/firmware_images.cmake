# Builds everything that is flashed for all microcontrollers, and the offenders that must be refused.

# build_test(NAME dir TARGETS targets...): a test that builds in a directory configured before.
function(build_test name directory)
  cmake_parse_arguments(build "" "REQUIRES" "TARGETS" ${ARGN})
  add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" --build "${directory}" --target ${build_TARGETS})
  set_tests_properties(${name} PROPERTIES LABELS guards TIMEOUT 1800
    FIXTURES_REQUIRED ${build_REQUIRES} RESOURCE_LOCK "${directory}")
endfunction()

# configure_test(NAME source dir processor SETS_UP fixture): a test that configures for a processor.
function(configure_test name source directory processor)
  cmake_parse_arguments(configure "" "SETS_UP;OPTIONS" "" ${ARGN})
  add_test(NAME ${name} COMMAND "${CMAKE_COMMAND}" -S "${source}" -B "${directory}" -G Ninja
    --toolchain "${PROJECT_SOURCE_DIR}/toolchains/arm-none-eabi-${processor}.cmake" -DBUILD_TESTING=OFF
    ${configure_OPTIONS})
  set_tests_properties(${name} PROPERTIES LABELS guards TIMEOUT 360
    FIXTURES_SETUP ${configure_SETS_UP} RESOURCE_LOCK "${directory}")
endfunction()

# Offender -> what its build must say; any other failure, and success, fails the test.
set(offender_heap "undefined reference to `operator new")
set(offender_heap_of_its_own "image gate: heap: malloc")
set(offender_exception "undefined reference to `__cxa_throw'")
set(offender_printing "undefined reference to `printf'")
set(offender_double_arithmetic "image gate: double precision: __aeabi_dmul")
set(offender_double_promotion "error: implicit conversion from 'float' to 'double'")
set(offender_big_stack_frame "error: stack usage is 20[0-9][0-9] bytes")
set(offender_big_state "RAM: no room for the stack")

foreach(processor cortex-m7 cortex-m4f cortex-m0plus)
  set(images "${PROJECT_SOURCE_DIR}/build/mcu-${processor}")
  configure_test(guards.${processor}.configure "${PROJECT_SOURCE_DIR}" "${images}" ${processor}
    SETS_UP images_${processor} OPTIONS -DZERORATE_TEST_IMAGES=ON)
  # A header that compiles alone for one processor does so for all.
  set(targets all)
  if(processor STREQUAL "cortex-m0plus")
    list(APPEND targets all_verify_interface_header_sets)
  endif()
  # Verifies SR-MEM-02.
  build_test(guards.${processor}.images "${images}" REQUIRES images_${processor} TARGETS ${targets})
  set_tests_properties(guards.${processor}.images PROPERTIES
    FIXTURES_SETUP built_${processor})

  if(processor STREQUAL "cortex-m0plus")
    build_test(guards.${processor}.relatives "${images}" REQUIRES built_${processor} TARGETS zerorate-pico-relatives)
    set_tests_properties(guards.${processor}.relatives PROPERTIES LABELS slow FIXTURES_SETUP built_relatives)
  endif()
  if(processor STREQUAL "cortex-m7")
    continue()  # as far as the gates are concerned an M4F
  endif()
  set(offenders "${CMAKE_CURRENT_BINARY_DIR}/offenders-${processor}")
  configure_test(guards.${processor}.configure_offenders
    "${CMAKE_CURRENT_SOURCE_DIR}/offenders" "${offenders}" ${processor} SETS_UP offenders_${processor})
  build_test(guards.${processor}.innocent_is_built "${offenders}"
    REQUIRES offenders_${processor} TARGETS innocent)
  foreach(offender heap heap_of_its_own exception printing double_arithmetic double_promotion
                   big_stack_frame big_state)
    # Verifies SR-MEM-02.
    set(test guards.${processor}.${offender}_is_refused)
    build_test(${test} "${offenders}" REQUIRES offenders_${processor} TARGETS ${offender})
    string(REGEX REPLACE "([()*+?])" "\\\\\\1" expected "${offender_${offender}}")
    set_tests_properties(${test} PROPERTIES PASS_REGULAR_EXPRESSION "${expected}")
  endforeach()
endforeach()
