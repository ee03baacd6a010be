// What a notebook runs for one cell: the page in a frame, and the relay between its port and the kernel (notebook_view.py).
export default {
  render({ model, el }) {
    const view = crypto.randomUUID();
    const { port1: port, port2 } = new MessageChannel();
    const frame = document.createElement('iframe');
    Object.assign(frame, { title: 'helibore', srcdoc: model.get('_page') });
    frame.style.cssText = 'width: 100%; height: 720px; border: 0';
    let own = false; // the page itself says where it looks
    const begin = ({ source, data }) => {
      if (source === frame.contentWindow && data === 'helibore') source.postMessage('helibore', '*', [port2]);
    };
    port.onmessage = ({ data: { traits, ...message } }) => {
      if (!traits) return model.send({ ...message, view });
      own = true;
      for (const [name, value] of Object.entries(traits)) model.set(name, value);
      own = false;
      model.save_changes();
    };
    const receive = ({ view: to, text, ...message }, buffers) => {
      if (to !== view) return;
      if (buffers?.length) {
        const { buffer, byteOffset, byteLength } = buffers[0];
        const bytes = buffer ? buffer.slice(byteOffset, byteOffset + byteLength) : buffers[0];
        port.postMessage(message.id ? { ...message, body: bytes } : bytes, [bytes]);
      } else port.postMessage(text ?? message);
    };
    const show = () => own || port.postMessage({ depths: model.get('depths') });
    const lost = () => model.comm_live === false && port.postMessage({ close: 1006, reason: '' });
    window.addEventListener('message', begin);
    model.on('msg:custom', receive);
    model.on('change:depths', show);
    model.on('comm_live_update', lost);
    // The picture that a saved notebook shows stands in a cell output of its own.
    for (const still of document.getElementsByClassName(model.get('_still'))) still.style.display = 'none';
    el.append(frame);
    return () => {
      window.removeEventListener('message', begin);
      model.off('msg:custom', receive);
      model.off('change:depths', show);
      model.off('comm_live_update', lost);
      model.send({ view, closed: true });
    };
  },
};
