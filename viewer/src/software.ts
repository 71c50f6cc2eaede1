// Whether there is a graphics card.

/** Words in the names of renderers that draw on the processor: Chromium's, Mesa's, Windows'. */
const BY_PROCESSOR = /SwiftShader|llvmpipe|softpipe|Software|Basic Render/i;

function nameOfRenderer(): string {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = names && gl?.getParameter(names.UNMASKED_RENDERER_WEBGL);
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return typeof name === "string" ? name : "";
}

/** Pictures are drawn by the processor, which has other things to do: with less smoothness, and points otherwise. */
export const IS_SOFTWARE = BY_PROCESSOR.test(nameOfRenderer());
