# The command line as a module for Node (gltf_ext/js/bin/worker.js loads it): real paths, memory that grows to the 4 GB of 32-bit addresses.
target_sources(gltf-nmc PRIVATE ${CMAKE_CURRENT_LIST_DIR}/node.cpp)
target_link_options(gltf-nmc PRIVATE
  -O3
  -sENVIRONMENT=node
  -sMODULARIZE=1
  -sEXIT_RUNTIME=1
  -sNODERAWFS=1
  -sNODEJS_CATCH_EXIT=0
  -sNODEJS_CATCH_REJECTION=0
  -sALLOW_MEMORY_GROWTH=1
  -sMAXIMUM_MEMORY=4GB
  -sINITIAL_MEMORY=64MB
  -sTOTAL_STACK=16MB
  -sEXPORTED_RUNTIME_METHODS=ENV
  -sEXPORTED_FUNCTIONS=_main,_malloc)
