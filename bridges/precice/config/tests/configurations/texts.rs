//! Texts of configurations.

/// Two participants with every kind of element, most of them in lines of their own.
pub(crate) const FULL: &str = r#"<?xml version="1.0"?>
<!-- A plate in a stream. <data:scalar name="Comment" /> -->
<precice-configuration experimental="yes">
  <log><sink filter="%Severity% &gt; debug" /></log>
  <profiling mode="all" />
  <data:scalar name="Pressure" waveform-degree="0" />
  <data:vector name="Motion" lower-bound-x="-1" />
  <mesh name="Wet" dimensions="2">
    <use-data name="Pressure" />
    <use-data name="Motion" />
  </mesh>
  <mesh name="Body" dimensions="2">
    <use-data name="Motion" />
    <use-data name="Pressure" />
  </mesh>
  <participant name="Stream">
    <provide-mesh name="Wet" />
    <receive-mesh name="Body" from="Plate" safety-factor="1.5" />
    <write-data name="Pressure" mesh="Wet" />
    <read-data name="Motion" mesh="Wet" />
    <mapping:rbf-pum-direct
      direction="write" from="Wet" to="Body" constraint="conservative"
      vertices-per-cluster="80">
      <basis-function:compact-polynomial-c4 support-radius="1/4" />
      <executor:openmp n-threads="2" />
    </mapping:rbf-pum-direct>
    <mapping:nearest-projection direction="read" from="Body" to="Wet" constraint="consistent" />
    <export:vtu directory="out" every-n-time-windows="5" every-iteration="1" />
    <intra-comm:sockets />
  </participant>
  <participant name="Plate">
    <provide-mesh name="Body" />
    <read-data name="Pressure" mesh="Body" />
    <write-data name="Motion" mesh="Body" />
    <watch-point name="Tip" mesh="Body" coordinate="0;1" />
    <watch-integral name="Load" mesh="Body" scale-with-connectivity="false" />
    <action:divide-by-area timing="read-mapping-post" mesh="Body">
      <target-data name="Pressure" />
    </action:divide-by-area>
  </participant>
  <m2n:sockets acceptor="Stream" connector="Plate" network="lo" />
  <coupling-scheme:parallel-implicit>
    <participants first="Stream" second="Plate" />
    <time-window-size value="0.1" />
    <max-time value="7" />
    <max-time-windows value="3" />
    <min-iterations value="2" />
    <max-iterations value="40" />
    <exchange data="Pressure" mesh="Body" from="Stream" to="Plate" initialize="on" />
    <exchange data="Motion" mesh="Body" from="Plate" to="Stream" substeps="true" />
    <relative-convergence-measure data="Pressure" mesh="Body" limit="1e-3" strict="1" />
    <absolute-convergence-measure data="Motion" mesh="Body" limit="1e-5" suffices="true" />
    <residual-relative-convergence-measure data="Motion" mesh="Body" limit="1e-4" />
    <absolute-or-relative-convergence-measure data="Pressure" mesh="Body" abs-limit="1"
      rel-limit="1e-4" />
    <acceleration:IQN-IMVJ always-build-jacobian="true">
      <data name="Motion" mesh="Body" scaling="2" />
      <preconditioner type="constant" freeze-after="4" />
      <filter type="QR1" limit="1e-9" />
      <initial-relaxation value="0.2" enforce="true" />
      <max-used-iterations value="30" />
      <time-windows-reused value="0" />
      <imvj-restart-mode type="RS-0" chunk-size="6" />
    </acceleration:IQN-IMVJ>
  </coupling-scheme:parallel-implicit>
</precice-configuration>
"#;

/// Two participants that exchange one number in each direction on the same mesh.
pub(crate) const SMALL: &str = r#"<precice-configuration>
  <data:scalar name="Force" />
  <data:scalar name="Way" />
  <mesh name="Point" dimensions="3"><use-data name="Force" /><use-data name="Way" /></mesh>
  <mesh name="Other" dimensions="3"><use-data name="Force" /><use-data name="Way" /></mesh>
  <participant name="Left">
    <provide-mesh name="Point" />
    <write-data name="Force" mesh="Point" />
    <read-data name="Way" mesh="Point" />
  </participant>
  <participant name="Right">
    <receive-mesh name="Point" from="Left" />
    <provide-mesh name="Other" />
    <read-data name="Force" mesh="Other" />
    <write-data name="Way" mesh="Other" />
    <mapping:nearest-neighbor direction="read" from="Point" to="Other" constraint="consistent" />
    <mapping:nearest-neighbor direction="write" from="Other" to="Point" constraint="consistent" />
  </participant>
  <coupling-scheme:serial-explicit>
    <participants first="Left" second="Right" />
    <time-window-size value="0.5" />
    <max-time value="2" />
    <exchange data="Force" mesh="Point" from="Left" to="Right" />
    <exchange data="Way" mesh="Point" from="Right" to="Left" />
  </coupling-scheme:serial-explicit>
</precice-configuration>
"#;

/// Returns a text in which a part is replaced, which has to be there.
pub(crate) fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from:?}");
    text.replace(from, to)
}

/// Returns the line of the first occurrence of a part.
pub(crate) fn line(text: &str, part: &str) -> usize {
    let at = text.find(part).unwrap_or_else(|| panic!("no {part:?}"));
    1 + text[..at].matches('\n').count()
}
