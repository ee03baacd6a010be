# The tag of C++ exceptions; compiled code names it, and a module without a dynamic linker defines it itself.
	.globl	__cpp_exception
	.tagtype	__cpp_exception i32
__cpp_exception:
