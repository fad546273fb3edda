//! The shapes of the roads in SUMO's network (<https://sumo.dlr.de/docs/Networks/SUMO_Road_Networks.html>).

use super::error::SumoFileError;
use super::xml::Xml;
use std::ops::ControlFlow;
use std::path::Path;

/// One road: an edge with the shape of its middle lane, so that the two directions of a street lie side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkRoad {
    /// SUMO's id of the edge; those within junctions begin with `:`.
    pub edge: String,
    /// Corners \[m\].
    pub shape: Vec<[f64; 2]>,
}

/// True if the root of the file is a network's.
pub fn is_network(path: &Path) -> bool {
    let mut found = false;
    let read = Xml::open(path).and_then(|mut xml| {
        xml.each(|element| {
            found = element.name() == "net";
            Ok(ControlFlow::Break(()))
        })
    });
    read.is_ok() && found
}

/// The roads that vehicles can drive on, in the order of the file. Walking areas and crossings are left out.
///
/// # Errors
/// [`SumoFileError`] if the file cannot be read, is no network, or breaks off.
pub fn network_roads(path: &Path) -> Result<Vec<NetworkRoad>, SumoFileError> {
    let mut xml = Xml::open(path)?;
    let (mut roads, mut lanes): (Vec<NetworkRoad>, Vec<Vec<[f64; 2]>>) = (Vec::new(), Vec::new());
    let mut edge: Option<String> = None;
    let mut end = |edge: Option<String>, lanes: &mut Vec<Vec<[f64; 2]>>| {
        if let (Some(edge), false) = (edge, lanes.is_empty()) {
            let middle = lanes.len() / 2;
            roads.push(NetworkRoad { edge, shape: lanes.swap_remove(middle) });
        }
        lanes.clear();
    };
    xml.each(|element| {
        match element.name() {
            "edge" => {
                end(edge.take(), &mut lanes);
                let walked = element.attribute("function").is_some_and(|f| f == "walkingarea" || f == "crossing");
                edge = element.attribute("id").filter(|_| !walked);
            }
            "lane" if edge.is_some() => lanes.push(shape(&element.attribute("shape").unwrap_or_default())?),
            _ => {}
        }
        Ok(ControlFlow::Continue(()))
    })?;
    end(edge, &mut lanes);
    if xml.is_whole() { Ok(roads) } else { Err(xml.breaks_off()) }
}

/// `x,y`, or with a height `x,y,z`, as finite numbers.
pub(super) fn place(text: &str) -> Option<[f64; 2]> {
    let mut numbers = text.split(',').map(|number| number.parse().ok().filter(|x: &f64| x.is_finite()));
    Some([numbers.next()??, numbers.next()??])
}

/// `x,y x,y ...`, or with heights `x,y,z`.
fn shape(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let corners: Option<Vec<_>> = text.split_whitespace().map(place).collect();
    corners.filter(|corners| !corners.is_empty()).ok_or_else(|| format!("shape=\"{text}\" is no list of places"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<NetworkRoad>, SumoFileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.net.xml");
        std::fs::write(&path, text).unwrap();
        assert!(is_network(&path));
        network_roads(&path)
    }

    #[test]
    fn a_road_has_the_shape_of_its_middle_lane() {
        let lane = |y| format!("<lane id=\"a_0\" shape=\"0,{y} 10.5,{y},3\"/>");
        let walk = "<edge id=\":w\" function=\"walkingarea\"><lane id=\":w_0\" shape=\"0,0 1,1\"/></edge>";
        let text = format!("<net><edge id=\"a\">{}{}{}</edge>{walk}</net>", lane(0), lane(3), lane(6));
        let road = NetworkRoad { edge: "a".into(), shape: vec![[0.0, 3.0], [10.5, 3.0]] };
        assert_eq!(read(&text).unwrap(), [road]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let error = read("<net>\n<edge id=\"a\">\n<lane shape=\"0;0\"/></edge></net>").unwrap_err().to_string();
        assert!(error.contains("a.net.xml") && error.contains('3') && error.contains("0;0"), "{error}");
        for corner in ["nan,0", "0,inf", "1e400,0", "0"] {
            let error =
                read(&format!("<net>\n<edge id=\"a\">\n<lane shape=\"0,0 {corner}\"/></edge></net>")).unwrap_err();
            assert!(
                error.to_string().ends_with(&format!(":3: shape=\"0,0 {corner}\" is no list of places")),
                "{error}"
            );
        }
        assert!(read("<net><edge id=\"a\">").unwrap_err().to_string().contains("breaks off"));
    }
}
