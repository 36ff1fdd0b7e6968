//! Maps that are two files, dropped on the page together.

use anyhow::Result;

use crate::opened::Opened;

/// An image of 3 × 2 heights, and its label in a file of its own.
fn pds() -> [(&'static str, Vec<u8>); 2] {
    let label = "PDS_VERSION_ID = PDS3\r\n^IMAGE = \"HILL.IMG\"\r\nOBJECT = IMAGE\r\n  LINES = 2\r\n  LINE_SAMPLES = 3\r\n\
        SAMPLE_TYPE = MSB_INTEGER\r\n  SAMPLE_BITS = 16\r\n  MISSING_CONSTANT = 16#8000#\r\nEND_OBJECT = IMAGE\r\n\
        MAP_SCALE = 0.02 <KM/PIXEL>\r\nEND\r\n";
    let heights = [1_i16, 2, 3, 4, i16::MIN, 6].iter().flat_map(|height| height.to_be_bytes());
    [("HILL.LBL", label.as_bytes().to_vec()), ("HILL.IMG", heights.collect())]
}

/// A map of ROS: free, unknown, in the way.
fn ros() -> [(&'static str, Vec<u8>); 2] {
    let yaml = "image: yard.pgm\nresolution: 0.5\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    [("yard.yaml", yaml.as_bytes().to_vec()), ("yard.pgm", b"P5\n3 1\n255\n\xfe\xcd\x00".to_vec())]
}

#[test]
fn a_description_and_its_image_that_are_dropped_together_are_one_map() -> Result<()> {
    let page = Opened::planned()?;
    for (files, said) in
        [(pds(), "Imported map HILL.IMG: 3 × 2 cells"), (ros(), "Imported map yard.yaml: 3 × 1 cells")]
    {
        page.tab.drop_files(&files.each_ref().map(|(name, bytes)| (*name, bytes.as_slice())))?;
        page.wait_for(&format!("state.toasts.some((toast) => toast.includes('{said}'))"))?;
        page.settle()?;
        let toasts = page.state()?["toasts"].to_string();
        assert!(!toasts.contains("Couldn't import"), "{toasts}");
    }
    // Nothing of them is a map by itself, and nothing waits for another file.
    let maps = page.state()?["library"]["missions"][0]["maps"].clone();
    assert_eq!(maps, serde_json::json!(["HILL.IMG", "yard.yaml"]));
    Ok(())
}
