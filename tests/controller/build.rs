fn main() {
    piaffe_codegen::Config::new("../downstream/model-spec").functions_only().compile();
}
