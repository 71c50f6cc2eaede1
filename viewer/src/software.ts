// Detects whether there is a graphics card.

/** Words in the names of software renderers: Chromium's, Mesa's, Windows'. */
const BY_PROCESSOR = /SwiftShader|llvmpipe|softpipe|Software|Basic Render/i;

function nameOfRenderer(): string {
  const gl = document.createElement("canvas").getContext("webgl2");
  const names = gl?.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = names && gl?.getParameter(names.UNMASKED_RENDERER_WEBGL);
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return typeof name === "string" ? name : "";
}

/** True if the processor draws the view: then at a lower rate, and points by other code. */
export const IS_SOFTWARE = BY_PROCESSOR.test(nameOfRenderer());
