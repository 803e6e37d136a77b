"""From a run to a smooth trajectory with a certificate: facet control, exact flow, smoothing, proof."""
