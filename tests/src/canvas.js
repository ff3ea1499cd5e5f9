// Draws shaders as pages do, and hands back the pixels and what the browser said of the text.
//
// A result is {complaint, pictures}: `complaint` is everything that was said, empty if nothing was; `pictures` are the
// pixels of each, four bytes a pixel in base 64, row by row; there are none where the shader was refused.

const base64 = bytes => {
  let characters = "";
  for (let i = 0; i < bytes.length; i += 0x8000) {
    characters += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  }
  return btoa(characters);
};

const gl = document.createElement("canvas").getContext("webgl2");
const corners = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
`;

// Rows from the bottom. Each uniform is {name, kind, values}, `kind` the end of the function's name that sets it.
function drawWithWebgl(fragments, frames, width, height) {
  if (!gl) return { complaint: "there is no WebGL2", pictures: [] };
  const program = gl.createProgram();
  let complaint = "";
  for (const [kind, text] of [[gl.VERTEX_SHADER, corners], [gl.FRAGMENT_SHADER, fragments]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    complaint += gl.getShaderInfoLog(shader) ?? "";
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  complaint += gl.getProgramInfoLog(program) ?? "";
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    return { complaint: complaint || "it was not linked", pictures: [] };
  }
  gl.useProgram(program);
  const buffer = gl.createRenderbuffer();
  gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, buffer);
  gl.viewport(0, 0, width, height);
  const pictures = frames.map(uniforms => {
    for (const { name, kind, values } of uniforms) {
      gl["uniform" + kind](gl.getUniformLocation(program, name), ...values);
    }
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const pixels = new Uint8Array(width * height * 4);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return base64(pixels);
  });
  const error = gl.getError();
  if (error !== gl.NO_ERROR) complaint += `error ${error} of WebGL`;
  gl.deleteProgram(program);
  return { complaint, pictures };
}

let device;

const webgpuDevice = async () => (await navigator.gpu?.requestAdapter())?.requestDevice();

// A compute shader's arguments lie at binding 0, its results at binding 1; its workgroups are of 64 invocations, in rows
// of 32,768. Both are words in base 64. The result is {complaint, words}.
async function computeWithWebgpu(text, input, invocations, words) {
  device ??= await webgpuDevice();
  if (!device) return { complaint: "there is no WebGPU" };
  device.pushErrorScope("validation");
  const module = device.createShaderModule({ code: text });
  const { messages } = await module.getCompilationInfo();
  const said = messages.map(m => `${m.type}, line ${m.lineNum}: ${m.message}\n`).join("");
  const pipeline = device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "main" } });
  const bytes = Uint8Array.from(atob(input), c => c.charCodeAt(0));
  const { STORAGE, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
  const [taken, left] = [bytes.length, words * 4].map(size =>
    device.createBuffer({ size, usage: STORAGE | COPY_DST | COPY_SRC }));
  device.queue.writeBuffer(taken, 0, bytes);
  const read = device.createBuffer({ size: words * 4, usage: COPY_DST | MAP_READ });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({
    layout: pipeline.getBindGroupLayout(0),
    entries: [taken, left].map((buffer, binding) => ({ binding, resource: { buffer } })),
  }));
  const groups = Math.ceil(invocations / 64);
  pass.dispatchWorkgroups(Math.min(groups, 32768), Math.ceil(groups / 32768));
  pass.end();
  encoder.copyBufferToBuffer(left, 0, read, 0, words * 4);
  device.queue.submit([encoder.finish()]);
  const refused = await device.popErrorScope();
  if (refused) return { complaint: said + refused.message };
  await read.mapAsync(MAP_READ);
  const result = base64(new Uint8Array(read.getMappedRange()));
  for (const buffer of [taken, left, read]) buffer.destroy();
  return { complaint: said, words: result };
}

// Rows from the top. `blocks` are the bytes of the uniform block of each picture, in base 64.
async function drawWithWebgpu(text, blocks, width, height) {
  device ??= await webgpuDevice();
  if (!device) return { complaint: "there is no WebGPU", pictures: [] };
  device.pushErrorScope("validation");
  const module = device.createShaderModule({ code: text });
  const { messages } = await module.getCompilationInfo();
  const said = messages.map(m => `${m.type}, line ${m.lineNum}: ${m.message}\n`);
  const pipeline = device.createRenderPipeline({
    layout: "auto",
    vertex: { module, entryPoint: "vs_main" },
    fragment: { module, entryPoint: "fs_main", targets: [{ format: "rgba8unorm" }] },
  });
  const refused = await device.popErrorScope();
  if (refused) return { complaint: said.join("") + refused.message, pictures: [] };
  device.pushErrorScope("validation");
  const pictures = [];
  for (const block of blocks) pictures.push(await webgpuPicture(pipeline, block, width, height));
  const failed = await device.popErrorScope();
  return { complaint: said.join("") + (failed?.message ?? ""), pictures };
}

async function webgpuPicture(pipeline, block, width, height) {
  const bytes = Uint8Array.from(atob(block), c => c.charCodeAt(0));
  const uniforms = device.createBuffer({ size: bytes.length, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
  device.queue.writeBuffer(uniforms, 0, bytes);
  const texture = device.createTexture({
    size: [width, height],
    format: "rgba8unorm",
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
  });
  const bytesPerRow = Math.ceil(width / 64) * 256;
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [{ view: texture.createView(), loadOp: "clear", storeOp: "store" }],
  });
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({
    layout: pipeline.getBindGroupLayout(0),
    entries: [{ binding: 0, resource: { buffer: uniforms } }],
  }));
  pass.draw(3);
  pass.end();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height]);
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const padded = new Uint8Array(buffer.getMappedRange());
  const pixels = new Uint8Array(width * height * 4);
  for (let row = 0; row < height; row++) {
    pixels.set(padded.subarray(row * bytesPerRow, row * bytesPerRow + width * 4), row * width * 4);
  }
  for (const thing of [buffer, texture, uniforms]) thing.destroy();
  return base64(pixels);
}
