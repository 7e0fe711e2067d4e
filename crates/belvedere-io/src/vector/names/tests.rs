use super::name_field;

#[test]
fn fields_of_names_are_found_in_many_spellings() {
    for field in [
        "name",
        "NAME",
        "Name",
        "Naam",
        "name:en",
        "NOM",
        "Nombre",
        "Bezeichn",
        "GN",
        "label_1",
        "Título",
        "FULLNAME",
        "名称",
        "NAMN1",
        "BEZEICHNUNG",
        "NAZ_OBJ",
        "local_name",
        "route_name",
        "NAME_1",
        "NAME_EN",
        "naam_nl",
        "Toponimo",
        "etiket",
        "Название",
        "Όνομα",
        "NAZEV",
        "gnis_name",
        "NOM_VOIE",
        "GeoName",
        "ref",
    ] {
        let keys = ["id", "kind", "height", "filename", "layer_name", "namespace", field, "length_m"];
        assert_eq!(name_field(keys.into_iter()), Some(field), "{field}");
    }
    let none = ["id", "namespace", "file_name", "username", "class_name", "renamed", "nominal", "PEAK", "tablename"];
    assert_eq!(name_field(none.into_iter()), None);
}

#[test]
fn the_best_field_counts_whatever_the_order() {
    for keys in [["ref", "name:en", "name"], ["name", "ref", "name:en"], ["alt_name", "old_name", "name"]] {
        assert_eq!(name_field(keys.into_iter()), Some("name"));
    }
    assert_eq!(name_field(["ref", "alt_name", "name:de"].into_iter()), Some("name:de"));
}
