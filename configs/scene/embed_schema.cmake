# cmake -D INPUT=scene.schema.json -D OUTPUT=scene_schema_text.cpp -P embed_schema.cmake
# Turns the schema into a source file, so that the programs need no file beside them.
file(READ ${INPUT} text)
file(WRITE ${OUTPUT} "#include \"configs/scene/scene_schema.hpp\"

namespace wade {

std::string_view scene_schema_text() {
    return R\"schema(${text})schema\";
}

}  // namespace wade
")
