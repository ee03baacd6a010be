import js from '@eslint/js';

const BROWSER = ['atob', 'btoa', 'clearInterval', 'clearTimeout', 'crypto', 'CSSStyleSheet', 'devicePixelRatio', 'document', 'fetch', 'history', 'location', 'localStorage', 'navigator', 'performance', 'requestAnimationFrame', 'setInterval', 'setTimeout', 'window', 'AbortSignal', 'MessageChannel', 'Option', 'Response', 'TextEncoder', 'Path2D', 'ResizeObserver', 'TextDecoder', 'URL', 'URLSearchParams', 'Blob', 'DecompressionStream', 'WebAssembly', 'Worker', 'postMessage', 'self', 'WebSocket', 'innerHeight', 'innerWidth'];

export default [
  {
    ...js.configs.recommended,
    languageOptions: { ecmaVersion: 2025, sourceType: 'module', globals: Object.fromEntries([...BROWSER, 'globalThis', 'console', 'process'].map((name) => [name, 'readonly'])) },
    rules: {
      ...js.configs.recommended.rules,
      'array-callback-return': 'error', curly: ['error', 'multi-line'], 'default-case-last': 'error', eqeqeq: 'error', 'no-else-return': 'error', 'no-implicit-coercion': 'error',
      'no-param-reassign': 'error', 'no-self-compare': 'error', 'no-shadow': 'error', 'no-template-curly-in-string': 'error', 'no-throw-literal': 'error', 'no-unmodified-loop-condition': 'error',
      'no-unused-vars': ['error', { ignoreRestSiblings: true }], 'no-use-before-define': ['error', { functions: false, variables: false, classes: false }], 'no-useless-return': 'error', 'no-var': 'error', 'object-shorthand': 'error', 'prefer-const': 'error', 'prefer-template': 'error',
    },
  },
];
