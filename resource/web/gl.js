// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// Draws textured rectangles in a room, and a vignette, with WebGL 2. Units are metres; x is to the
// right, y up and -z ahead, as in WebXR.

const VERTEX = `#version 300 es
uniform mat4 projection, view;
uniform vec3 centre, right, up;
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  at = vec2(corner.x, 1.0 - corner.y);
  corner = 2.0 * corner - 1.0;
  gl_Position = projection * view * vec4(centre + corner.x * right + corner.y * up, 1.0);
}`;
// With dark > 0 it draws the vignette: clear in the middle, dark towards the edge.
const FRAGMENT = `#version 300 es
precision mediump float;
uniform sampler2D image;
uniform float dark, light;
in vec2 at;
out vec4 colour;
void main() {
  if (dark > 0.0)
    colour = vec4(0.0, 0.0, 0.0, dark * smoothstep(0.24, 0.48, distance(at, vec2(0.5))));
  else
    colour = vec4(light * texture(image, at).rgb, 1.0);
}`;
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const NAMES = ['projection', 'view', 'centre', 'right', 'up', 'image', 'dark', 'light'];

// Returns the place of a rectangle that faces the viewer: `yaw` to the left and `pitch`, how far its
// upper edge leans away [rad], at a height relative to the eyes and a distance [m].
export function place(yaw, height, distance, wide, high, pitch = 0) {
  const [s, c] = [Math.sin(yaw), Math.cos(yaw)];
  const lean = Math.sin(pitch) * high / 2;
  return {
    centre: [-s * distance, height, -c * distance],
    right: [c * wide / 2, 0, -s * wide / 2],
    up: [-s * lean, Math.cos(pitch) * high / 2, -c * lean],
  };
}

export class Painter {
  // Throws an Error if the browser cannot compile the shaders.
  constructor(gl) {
    this.gl = gl;
    const program = this.#program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program) || 'no WebGL');
    this.#at = Object.fromEntries(NAMES.map(name => [name, gl.getUniformLocation(program, name)]));
  }
  #program;
  #at;

  // Returns a new texture; an image, canvas or ImageBitmap is stored in it by `fill`.
  texture() {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const [what, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, what, value);
    return texture;
  }

  fill(texture, image) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
  }

  remove(texture) {
    this.gl.deleteTexture(texture);
  }

  // Starts a frame of the session's framebuffer.
  begin(framebuffer) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.clearColor(0.04, 0.05, 0.06, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.#program);
    gl.uniform1i(this.#at.image, 0);
  }

  // Starts the view of one eye: a viewport, and column-major matrices as of an XRView.
  look(viewport, projection, view) {
    const gl = this.gl;
    gl.viewport(viewport.x, viewport.y, viewport.width, viewport.height);
    gl.uniformMatrix4fv(this.#at.projection, false, projection);
    gl.uniformMatrix4fv(this.#at.view, false, view);
  }

  // Draws a texture on a rectangle of `place`; what is drawn later is in front.
  draw(texture, where, light = 1, dark = 0) {
    const gl = this.gl, at = this.#at;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    for (const name of ['centre', 'right', 'up']) gl.uniform3fv(at[name], where[name]);
    gl.uniform1f(at.light, light);
    gl.uniform1f(at.dark, dark);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  // Darkens the edge of the view of one eye, from 0 to 1.
  vignette(dark) {
    const gl = this.gl, at = this.#at;
    gl.uniformMatrix4fv(at.projection, false, IDENTITY);
    gl.uniformMatrix4fv(at.view, false, IDENTITY);
    this.draw(null, {centre: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0]}, 1, dark);
  }
}
