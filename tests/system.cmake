# Tests of the finished programs, seen from outside; no C++ here.
#   arm        the kernels compile for ARM; needs a cross compiler
#   bench      the interface of latvox_bench that scripts use
#   corpus     meshes of installed packages, compared with readers of others
#   layering   who depends on whom
#   prose      the English of pages and comments
#   python     the Python package
#   node       an independent client, from the protocol file alone
#   e2e        command line tool, files, failures
#   mutants    damaged files of every format
#   faults     overload, rudeness and sudden death: figures in a table; see tests/README.md
#   readme     the examples of README.md, client/docs and server/docs
#   deploy     containers, Kubernetes, Slurm: only by `tests/run --deploy`, except tests that take a moment
# A build with sanitizers runs at most the failures. The others are about results, and slow there.

# Registers a command. Further arguments are test properties.
function(latvox_add_system_test name command)
  add_test(NAME ${name} COMMAND ${command} WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR})
  set(environment "LATVOX_BIN=${PROJECT_BINARY_DIR}/bin;LATVOX_BUILD_DIR=${PROJECT_BINARY_DIR}")
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "${environment}" TIMEOUT 600 ${ARGN})
endfunction()

set(latvox_python /usr/bin/python3 -B) # Debian's own, for python3-openvdb
# In one run of several builds, tests of the same name would share one environment, and so one build.
if(NOT latvox_sanitized)
  latvox_add_system_test(e2e.errors "${latvox_python};e2e/errors_test.py")
elseif(NOT latvox_thread_sanitizer)
  latvox_add_system_test(e2e.errors_sanitized "${latvox_python};e2e/errors_test.py")
endif()
if(NOT latvox_sanitized)
  latvox_add_system_test(arm "${latvox_python};arm/compile_test.py" SKIP_RETURN_CODE 77 LABELS slow)
  latvox_add_system_test(bench "${latvox_python};bench/bench_test.py")
  latvox_add_system_test(corpus "${latvox_python};corpus/corpus_test.py")
  latvox_add_system_test(deploy.kubernetes "node;--test;deploy/kubernetes/manifests.test.js")
  latvox_add_system_test(deploy.kustomize "node;deploy/kubernetes/kustomize.test.js" SKIP_RETURN_CODE 77)
  latvox_add_system_test(deploy.recipes "${latvox_python};deploy/recipes_test.py")
  latvox_add_system_test(deploy.scale "${latvox_python};deploy/scale_test.py")
  latvox_add_system_test(deploy.tarball "${latvox_python};deploy/tarball_test.py" RESOURCE_LOCK install SKIP_RETURN_CODE 77)
  latvox_add_system_test(e2e.algorithms "${latvox_python};e2e/algorithms_test.py")
  latvox_add_system_test(e2e.align "${latvox_python};e2e/align_test.py")
  latvox_add_system_test(e2e.fields "${latvox_python};e2e/fields_test.py")
  latvox_add_system_test(e2e.band "${latvox_python};e2e/band_test.py")
  latvox_add_system_test(e2e.batch "${latvox_python};e2e/batch_test.py")
  latvox_add_system_test(e2e.bounds "${latvox_python};e2e/bounds_test.py")
  latvox_add_system_test(e2e.box "${latvox_python};e2e/box_test.py")
  latvox_add_system_test(e2e.calls "${latvox_python};e2e/calls_test.py")
  latvox_add_system_test(e2e.config "${latvox_python};e2e/config_test.py")
  latvox_add_system_test(e2e.convert "${latvox_python};e2e/convert_test.py")
  latvox_add_system_test(e2e.counts "${latvox_python};e2e/counts_test.py" LABELS slow)
  latvox_add_system_test(e2e.damaged "${latvox_python};e2e/damaged_test.py")
  latvox_add_system_test(e2e.difference "${latvox_python};e2e/difference_test.py")
  latvox_add_system_test(e2e.digest "${latvox_python};e2e/digest_test.py")
  latvox_add_system_test(e2e.docs "${latvox_python};e2e/docs_test.py")
  latvox_add_system_test(e2e.examples "${latvox_python};e2e/examples_test.py")
  latvox_add_system_test(e2e.exhaustion "${latvox_python};e2e/exhaustion_test.py")
  latvox_add_system_test(e2e.far "${latvox_python};e2e/far_test.py")
  latvox_add_system_test(e2e.service_manager "${latvox_python};e2e/service_manager_test.py")
  latvox_add_system_test(e2e.sbom "${latvox_python};e2e/sbom_test.py")
  latvox_add_system_test(e2e.release "${latvox_python};e2e/release_test.py")
  latvox_add_system_test(e2e.versions "${latvox_python};e2e/versions_test.py")
  latvox_add_system_test(e2e.texture "${latvox_python};e2e/texture_test.py")
  latvox_add_system_test(e2e.upload "${latvox_python};e2e/upload_test.py")
  latvox_add_system_test(e2e.hdf5 "${latvox_python};e2e/hdf5_test.py")
  latvox_add_system_test(e2e.fraction "${latvox_python};e2e/fraction_test.py")
  latvox_add_system_test(e2e.label_fractions "${latvox_python};e2e/label_fractions_test.py")
  latvox_add_system_test(e2e.formats "${latvox_python};e2e/formats_test.py")
  latvox_add_system_test(e2e.gltf "${latvox_python};e2e/gltf_test.py")
  latvox_add_system_test(e2e.info "${latvox_python};e2e/info_test.py")
  latvox_add_system_test(e2e.input "${latvox_python};e2e/input_test.py")
  latvox_add_system_test(e2e.links "${latvox_python};e2e/links_test.py")
  latvox_add_system_test(e2e.leftovers "${latvox_python};e2e/leftovers_test.py")
  latvox_add_system_test(e2e.manners "${latvox_python};e2e/manners_test.py")
  latvox_add_system_test(e2e.manual "${latvox_python};e2e/manual_test.py" RESOURCE_LOCK install)
  latvox_add_system_test(e2e.merge "${latvox_python};e2e/merge_test.py")
  latvox_add_system_test(e2e.merge_fields "${latvox_python};e2e/merge_fields_test.py")
  latvox_add_system_test(e2e.metrics "${latvox_python};e2e/metrics_test.py")
  latvox_add_system_test(e2e.labels "${latvox_python};e2e/labels_test.py")
  latvox_add_system_test(e2e.names "${latvox_python};e2e/names_test.py")
  latvox_add_system_test(e2e.npz "${latvox_python};e2e/npz_test.py")
  latvox_add_system_test(e2e.openvdb "${latvox_python};e2e/openvdb_test.py")
  if(TARGET latvox_vdb)
    latvox_add_system_test(e2e.openvdb_late "${latvox_python};e2e/openvdb_late_test.py")
  endif()
  latvox_add_system_test(e2e.picture "${latvox_python};e2e/picture_test.py")
  latvox_add_system_test(e2e.opened "${latvox_python};e2e/opened_test.py")
  latvox_add_system_test(e2e.pixelize "${latvox_python};e2e/pixelize_test.py")
  latvox_add_system_test(e2e.science "${latvox_python};e2e/science_test.py")
  latvox_add_system_test(e2e.sdk "${latvox_python};e2e/sdk_test.py" RESOURCE_LOCK install)
  latvox_add_system_test(e2e.sdk_alone "${latvox_python};e2e/sdk_alone_test.py")
  latvox_add_system_test(e2e.solid "${latvox_python};e2e/solid_test.py")
  latvox_add_system_test(e2e.enclosed "${latvox_python};e2e/enclosed_test.py")
  latvox_add_system_test(e2e.stores "${latvox_python};e2e/stores_test.py")
  latvox_add_system_test(e2e.stretched "${latvox_python};e2e/stretched_test.py")
  latvox_add_system_test(e2e.supercover "${latvox_python};e2e/supercover_test.py")
  latvox_add_system_test(e2e.surface "${latvox_python};e2e/surface_test.py")
  latvox_add_system_test(e2e.terminal "${latvox_python};e2e/terminal_test.py")
  latvox_add_system_test(e2e.three_mf "${latvox_python};e2e/three_mf_test.py")
  latvox_add_system_test(e2e.tls "${latvox_python};e2e/tls_test.py")
  latvox_add_system_test(e2e.protocol "${latvox_python};e2e/protocol_test.py")
  latvox_add_system_test(e2e.trace "${latvox_python};e2e/trace_test.py")
  latvox_add_system_test(e2e.values "${latvox_python};e2e/values_test.py")
  latvox_add_system_test(e2e.warnings "${latvox_python};e2e/warnings_test.py")
  latvox_add_system_test(e2e.view "${latvox_python};e2e/view_test.py")
  latvox_add_system_test(mutants "${latvox_python};mutants/mutants_test.py" LABELS slow TIMEOUT 100000)
  latvox_add_system_test(node.view "node;--test;node/view.test.js")
  # They need both cores for themselves, because their figures assume an otherwise idle machine.
  latvox_add_system_test(faults.prepare "${latvox_python};faults/prepare.py" FIXTURES_SETUP faults RUN_SERIAL ON)
  foreach(scenario swarm kill readers attacks half_open sigterm mutated fairness tenants cancel overhead gateway stores)
    latvox_add_system_test(faults.${scenario} "${latvox_python};faults/${scenario}_test.py" FIXTURES_REQUIRED faults
                           LABELS slow RUN_SERIAL ON SKIP_RETURN_CODE 77 TIMEOUT 3600)
  endforeach()
  latvox_add_system_test(deploy.gateway "${latvox_python};deploy/gateway_test.py")
  latvox_add_system_test(deploy.gateway_operations "${latvox_python};deploy/gateway_operations_test.py")
  latvox_add_system_test(deploy.gateway_page "${latvox_python};deploy/gateway_page_test.py")
  latvox_add_system_test(deploy.languages "${latvox_python};deploy/languages_test.py")
  latvox_add_system_test(deploy.haproxy "${latvox_python};deploy/haproxy_test.py")
  latvox_add_system_test(deploy.strangers "${latvox_python};deploy/strangers_test.py")
  # The first of these makes the image that the others run. Networks of containers share one name server.
  latvox_add_system_test(deploy.image_build "${latvox_python};deploy/image_build_test.py" FIXTURES_SETUP image LABELS deploy
                         RUN_SERIAL ON SKIP_RETURN_CODE 77 TIMEOUT 3600)
  latvox_add_system_test(deploy.gateway_image "${latvox_python};deploy/gateway_image_test.py" LABELS deploy RUN_SERIAL ON
                         SKIP_RETURN_CODE 77 TIMEOUT 1800)
  foreach(name image compose image_readme kubernetes_pod slurm_container)
    latvox_add_system_test(deploy.${name} "${latvox_python};deploy/${name}_test.py" FIXTURES_REQUIRED image LABELS deploy
                           RUN_SERIAL ON SKIP_RETURN_CODE 77 TIMEOUT 1800)
  endforeach()
  latvox_add_system_test(deploy.packages "${latvox_python};deploy/packages_test.py" LABELS deploy RUN_SERIAL ON
                         SKIP_RETURN_CODE 77 TIMEOUT 1200)
  latvox_add_system_test(deploy.tarball_roots "${latvox_python};deploy/tarball_roots_test.py" LABELS deploy RUN_SERIAL ON
                         SKIP_RETURN_CODE 77 TIMEOUT 1800)
  latvox_add_system_test(deploy.scale_measure "${latvox_python};deploy/scale_measure_test.py" LABELS deploy RUN_SERIAL ON)
  latvox_add_system_test(deploy.slurm "${latvox_python};deploy/slurm_test.py" LABELS deploy RUN_SERIAL ON
                         SKIP_RETURN_CODE 77)
  latvox_add_system_test(e2e.resume "${latvox_python};e2e/resume_test.py")
  latvox_add_system_test(layering "${latvox_python};layering/layering_test.py")
  latvox_add_system_test(layering.function_length "${latvox_python};layering/function_length_test.py")
  latvox_add_system_test(layering.rooms "${latvox_python};layering/rooms_test.py")
  if(LATVOX_PYTHON)
    latvox_add_system_test(python.package "${latvox_python};-m;pytest;-q;-p;no:cacheprovider;python")
  endif()
  latvox_add_system_test(prose "${latvox_python};prose/prose_test.py")
  latvox_add_system_test(node "node;--test;node/voxelize.test.js")
  latvox_add_system_test(readme "${latvox_python};readme/readme_test.py")
endif()
